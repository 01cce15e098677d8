//! A server that speaks S3, on a loopback port: `moto`, out of the Python environment that `tests/run` makes.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
};

use crate::Server;

/// The bucket that is made.
const BUCKET: &str = "joulepath";

/// A running server with an empty bucket, ended when dropped.
#[derive(Debug)]
pub struct S3 {
    child: Child,
    address: String,
}

impl S3 {
    /// Starts one, if the Python environment is there.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start() -> Option<S3> {
        let program = python_folder()?.join("bin/moto_server");
        if !program.exists() {
            return None;
        }
        let mut child = Command::new(program)
            .args(["--host", "127.0.0.1", "--port", "0"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("moto does not start: {error}"));
        let stderr = child.stderr.take().unwrap_or_else(|| panic!("moto's output was not kept"));
        let mut lines = BufReader::new(stderr).lines().map_while(Result::ok);
        let told = lines.find_map(|line| line.split("http://").nth(1).map(|rest| rest.trim().to_owned()));
        let address = told.unwrap_or_else(|| panic!("moto does not say where it listens"));
        // What it says later must not fill the pipe.
        std::thread::spawn(move || lines.for_each(drop));
        let s3 = S3 { child, address };
        s3.make_bucket();
        Some(s3)
    }

    /// Starts a service over the bucket, in which a killed service's jobs are taken up soon.
    ///
    /// # Panics
    /// When it does not start.
    pub fn service(&self) -> Server {
        let endpoint = format!("http://{}", self.address);
        let environment = [
            ("AWS_ENDPOINT_URL", endpoint.as_str()),
            ("AWS_ALLOW_HTTP", "true"),
            ("AWS_REGION", "us-east-1"),
            ("AWS_ACCESS_KEY_ID", "test"),
            ("AWS_SECRET_ACCESS_KEY", "test"),
        ];
        let store = format!("s3://{BUCKET}/some/prefix");
        Server::start_in("127.0.0.1:0", &["--store", &store, "--lease-s", "5"], &environment)
    }

    /// Ends it, so that services find their store out of reach.
    pub fn stop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    fn make_bucket(&self) {
        let made = TcpStream::connect(&self.address).and_then(|mut stream| {
            let host = &self.address;
            write!(
                stream,
                "PUT /{BUCKET} HTTP/1.1\r\nhost: {host}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n"
            )?;
            let mut answer = String::new();
            stream.read_to_string(&mut answer)?;
            Ok(answer)
        });
        assert!(made.as_ref().is_ok_and(|answer| answer.contains(" 200 ")), "no bucket: {made:?}");
    }
}

impl Drop for S3 {
    fn drop(&mut self) {
        self.stop();
    }
}

/// The Python environment, beside the profile that the tests were built in.
fn python_folder() -> Option<PathBuf> {
    let tests = std::env::current_exe().ok()?;
    tests.ancestors().map(|folder| folder.join("python")).find(|python: &PathBuf| Path::exists(python))
}
