//! `--store`: which place is meant, and whether it can be used.

use std::{io, path::Path, sync::Arc, time::Duration};

use object_store::{
    BackoffConfig, ClientConfigKey, ObjectStore, RetryConfig,
    aws::{AmazonS3Builder, AmazonS3ConfigKey},
    local::LocalFileSystem,
    prefix::PrefixStore,
};

use super::{folder::Folder, plain_words::plain_words};

/// How long a bucket is asked again before it counts as out of reach: a client waits for it.
const RETRY_TIME: Duration = Duration::from_secs(5);
const RETRIES: usize = 3;
/// How long one request to a bucket may take; a part of an upload is 10 MB.
const REQUEST_TIME: &str = "60 seconds";
const CONNECT_TIME: &str = "3 seconds";

/// Why a store cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// A folder that cannot be made, written or locked.
    #[error("cannot keep anything in {place}: {source}; give --store a folder that can be written to")]
    Folder {
        /// The folder.
        place: String,
        /// What the system says.
        source: io::Error,
    },
    /// Another kind of place.
    #[error("--store {place}: give a folder or s3://BUCKET/PREFIX")]
    Scheme {
        /// What was given.
        place: String,
    },
    /// A bucket that is not described well enough to ask it.
    #[error(
        "--store {place}: {}; AWS_ENDPOINT_URL, AWS_REGION, AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY say where it is and who asks",
        plain_words(source)
    )]
    Bucket {
        /// The bucket.
        place: String,
        /// What is missing.
        source: object_store::Error,
    },
    /// The system gives no means to ask the store.
    #[error("cannot start: {source}")]
    System {
        /// What the system says.
        source: io::Error,
    },
    /// A place that does not take an object and give it back.
    #[error("cannot use --store {place}: {}", plain_words(source))]
    Unusable {
        /// The place.
        place: String,
        /// What happened.
        source: object_store::Error,
    },
}

/// An opened place.
pub(super) struct Place {
    pub(super) objects: Arc<dyn ObjectStore>,
    /// Where it is a folder.
    pub(super) folder: Option<Folder>,
    /// Whether no other service can be using it.
    pub(super) alone: bool,
}

impl Place {
    /// Opens a folder or a bucket; without either, a folder that lasts as long as the service.
    pub(super) fn open(place: Option<&str>) -> Result<Place, StoreError> {
        if let Some((scheme, rest)) = place.and_then(|place| place.split_once("://")) {
            let place = place.unwrap_or_default().to_owned();
            if scheme != "s3" {
                return Err(StoreError::Scheme { place });
            }
            let objects = bucket(rest).map_err(|source| StoreError::Bucket { place, source })?;
            return Ok(Place { objects, folder: None, alone: false });
        }
        let named = || place.unwrap_or("the temporary folder").to_owned();
        let (folder, alone) = Folder::open(place.map(Path::new))
            .map_err(|source| StoreError::Folder { place: named(), source })?;
        let objects = LocalFileSystem::new_with_prefix(folder.root())
            .map_err(|source| StoreError::Unusable { place: named(), source })?;
        Ok(Place { objects: Arc::new(objects.with_fsync(true)), folder: Some(folder), alone })
    }
}

/// A bucket and the prefix of all names in it; the rest is in the environment.
pub(super) fn bucket(address: &str) -> object_store::Result<Arc<dyn ObjectStore>> {
    // The client is built without cryptography of its own. Who comes second finds what the first has chosen.
    let _ = rustls::crypto::ring::default_provider().install_default();
    let (bucket, prefix) = address.split_once('/').unwrap_or((address, ""));
    let retry =
        RetryConfig { backoff: BackoffConfig::default(), max_retries: RETRIES, retry_timeout: RETRY_TIME };
    let client = AmazonS3Builder::from_env()
        .with_bucket_name(bucket)
        .with_retry(retry)
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::Timeout), REQUEST_TIME)
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::ConnectTimeout), CONNECT_TIME)
        .build()?;
    Ok(Arc::new(PrefixStore::new(client, prefix)))
}
