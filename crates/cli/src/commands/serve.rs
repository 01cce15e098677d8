//! `joulepath serve`.

use std::{
    fs,
    net::{SocketAddr, TcpListener, ToSocketAddrs},
    path::{Path, PathBuf},
    time::Duration,
};

use clap::{Args, ValueEnum, builder::FalseyValueParser};
use service::{Access, Engine, Hosts, Tiles, Tokens, serve};
use tracing_subscriber::EnvFilter;

use crate::{allocator::give_back_freed_memory, failure::BadInput, limit_arguments::LimitArguments, output};

/// Variable of the environment that holds tokens themselves.
const TOKENS: &str = "JOULEPATH_TOKENS";
/// How long `--check` waits for an answer.
const CHECK_TIME: Duration = Duration::from_secs(3);

#[derive(Args)]
#[command(
    after_help = "Every setting can also stand in the environment (names above) or, as `bind = \"127.0.0.1:8080\"`, in the file of \
                  --config. Flags stand above the environment, and that above the file. JOULEPATH_TOKENS may hold tokens as the file of \
                  --token-file does; RUST_LOG says what is logged (default: info)."
)]
pub(crate) struct Arguments {
    /// Address and port to listen on; beyond this machine only with tokens or --insecure-open
    #[arg(long, env = "JOULEPATH_BIND", default_value = "127.0.0.1:8080")]
    bind: String,
    /// Folder or s3://BUCKET/PREFIX that maps, robots, recordings, jobs and reports are kept in, shared by all services that
    /// are given it; AWS_ENDPOINT_URL, AWS_REGION, AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_ALLOW_HTTP say where a
    /// bucket is and who asks [default: a folder that lasts as long as the service]
    #[arg(long, env = "JOULEPATH_STORE")]
    store: Option<String>,
    /// TOML file of settings, named as the flags are with _ for -
    #[arg(long, env = "JOULEPATH_CONFIG")]
    config: Option<PathBuf>,
    /// File of tokens, NAME:TOKEN to a line: requests then need `Authorization: Bearer TOKEN`, and see only what their tenant
    /// NAME owns; a token without a name belongs to the tenant `default`, one of the name `admin` sees everything
    #[arg(long, env = "JOULEPATH_TOKEN_FILE")]
    token_file: Option<PathBuf>,
    /// Let anybody ask who reaches the address, without a token
    #[arg(long, env = "JOULEPATH_INSECURE_OPEN", value_parser = FalseyValueParser::new())]
    insecure_open: bool,
    /// Origin whose pages may ask, as `https://maps.example.org`; may be given several times [default: none]
    #[arg(long, env = "JOULEPATH_CORS_ORIGIN", value_delimiter = ',')]
    cors_origin: Vec<String>,
    /// Name by which the service is asked, as `maps.example.org` behind a proxy; may be given several times. Without tokens, no
    /// other name than localhost is answered [default: none]
    #[arg(long, env = "JOULEPATH_HOST", value_delimiter = ',', value_name = "NAME")]
    host: Vec<String>,
    /// Tiles of pictures that the page may lay under paths, as `https://tiles.example.org/{z}/{x}/{y}.png` in Web Mercator; who looks at
    /// the page asks that host for them [default: none]
    #[arg(long, env = "JOULEPATH_TILES", value_name = "URL")]
    tiles: Option<String>,
    /// Whom the tiles are from, which the page shows beside them
    #[arg(long, env = "JOULEPATH_TILES_ATTRIBUTION", value_name = "TEXT", requires = "tiles")]
    tiles_attribution: Option<String>,
    /// Largest zoom that there are tiles of
    #[arg(long, env = "JOULEPATH_TILES_MAX_ZOOM", value_name = "Z", default_value_t = 19, value_parser = clap::value_parser!(u8).range(0..=24))]
    tiles_max_zoom: u8,
    /// Form of the log on stderr
    #[arg(long, env = "JOULEPATH_LOG_FORMAT", value_enum, default_value_t = LogFormat::Json)]
    log_format: LogFormat,
    /// Ask the service that listens at --bind whether it is ready; exits with 0 if so, 1 if not
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    limits: LimitArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LogFormat {
    /// One JSON object to a line
    Json,
    /// For people
    Text,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.check {
        return check(&arguments.bind);
    }
    give_back_freed_memory();
    let addresses = addresses(&arguments.bind)?;
    let access = access(arguments, &addresses)?;
    log(arguments.log_format);
    let listener = TcpListener::bind(&addresses[..])
        .map_err(|error| BadInput(format!("cannot listen on --bind {}: {error}", arguments.bind)))?;
    let limits = arguments.limits.limits(&access.tokens);
    let engine =
        Engine::new(limits, arguments.store.as_deref()).map_err(|error| BadInput(error.to_string()))?;
    // The service is there for who asks it, whether or not somebody reads its output.
    match output::line(format_args!("listening on http://{}", listener.local_addr()?)) {
        Err(error) if !error.is::<output::ReaderLeft>() => return Err(error),
        _ => {}
    }
    serve(listener, engine, &access)?;
    Ok(())
}

fn addresses(bind: &str) -> Result<Vec<SocketAddr>, BadInput> {
    let found = bind.to_socket_addrs().map(Iterator::collect::<Vec<_>>);
    match found {
        Ok(found) if !found.is_empty() => Ok(found),
        Ok(_) => Err(BadInput(format!("--bind {bind} is no address: give one as 127.0.0.1:8080"))),
        Err(error) => {
            Err(BadInput(format!("--bind {bind}: {error}; give an address and port as 127.0.0.1:8080")))
        }
    }
}

/// Who may ask. An address that others reach needs tokens, or somebody's word that it does not.
fn access(arguments: &Arguments, addresses: &[SocketAddr]) -> anyhow::Result<Access> {
    let tokens = tokens(arguments.token_file.as_deref())?;
    let is_local = addresses.iter().all(|address| address.ip().is_loopback());
    if !is_local && tokens.is_empty() && !arguments.insecure_open {
        let detail = format!(
            "--bind {} can be reached from other machines: give tokens (--token-file FILE or {TOKENS}), or --insecure-open to let \
             anybody in",
            arguments.bind
        );
        return Err(BadInput(detail).into());
    }
    let origin = |text: &String| {
        let is_origin = text.split_once("://").is_some_and(|(scheme, host)| {
            matches!(scheme, "http" | "https") && !host.is_empty() && !host.contains('/')
        });
        let refused = || {
            BadInput(format!(
                "--cors-origin {text} is no origin: give scheme and host as https://maps.example.org"
            ))
        };
        text.parse().ok().filter(|_| is_origin).ok_or_else(refused)
    };
    let cors_origins = arguments.cors_origin.iter().map(origin).collect::<Result<_, _>>()?;
    let hosts = Hosts::named(&arguments.host, !is_local).map_err(|error| BadInput(error.to_string()))?;
    let tiles = arguments.tiles.as_deref().map(|url| {
        let attribution = arguments.tiles_attribution.as_deref().unwrap_or_default();
        Tiles::from_template(url, attribution, arguments.tiles_max_zoom)
            .map_err(|error| BadInput(format!("--tiles {error}")))
    });
    Ok(Access { tokens, open_metrics: is_local, cors_origins, hosts, tiles: tiles.transpose()? })
}

fn tokens(file: Option<&Path>) -> Result<Tokens, BadInput> {
    let read = |path: &Path| {
        let text = fs::read_to_string(path)
            .map_err(|error| BadInput(format!("--token-file {}: {error}", path.display())))?;
        let tokens = Tokens::parse(&text)
            .map_err(|error| BadInput(format!("--token-file {}: {error}", path.display())))?;
        match tokens.is_empty() {
            true => Err(BadInput(format!("--token-file {} holds no token", path.display()))),
            false => Ok(tokens),
        }
    };
    let of_file = file.map(read).transpose()?.unwrap_or_default();
    let of_environment = Tokens::parse(&std::env::var(TOKENS).unwrap_or_default())
        .map_err(|error| BadInput(format!("{TOKENS}: {error}")))?;
    of_file.and(of_environment).map_err(|error| BadInput(format!("{TOKENS}: {error}")))
}

fn log(format: LogFormat) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    let subscriber = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    // Who no longer reads the log does not end the service: by default a failed write is itself printed, which panics.
    let subscriber = subscriber.log_internal_errors(false);
    match format {
        LogFormat::Json => subscriber.json().with_span_list(false).init(),
        LogFormat::Text => subscriber.init(),
    }
}

/// Asks a service whether it is ready, as a container's health check does.
fn check(bind: &str) -> anyhow::Result<()> {
    let mut address = addresses(bind)?[0];
    if address.ip().is_unspecified() {
        address.set_ip(if address.is_ipv4() {
            [127, 0, 0, 1].into()
        } else {
            std::net::Ipv6Addr::LOCALHOST.into()
        });
    }
    let agent: ureq::Agent = ureq::Agent::config_builder().timeout_global(Some(CHECK_TIME)).build().into();
    agent.get(format!("http://{address}/readyz")).call()?;
    Ok(())
}
