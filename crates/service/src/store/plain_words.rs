//! What a store says when it refuses, without what only its owner may know.

use std::error::Error;

/// Variables of the environment whose values are never repeated.
const SECRETS: [&str; 3] = ["AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN"];
/// Shortest value that is hidden [bytes]: shorter ones are parts of ordinary words.
const SHORTEST_SECRET: usize = 4;

/// Returns an error's message in one line. Of a document that the store answered with, only its code and message stay, because
/// S3 repeats the key id and the signed request in it; values of secrets are hidden wherever they stand.
pub(super) fn plain_words(error: &(dyn Error + 'static)) -> String {
    let secrets: Vec<String> = SECRETS.iter().filter_map(|name| std::env::var(name).ok()).collect();
    without_secrets(&error.to_string(), &secrets)
}

fn without_secrets(message: &str, secrets: &[String]) -> String {
    let document = message.find("<?xml").or_else(|| message.find("<Error>"));
    let mut plain = match document {
        Some(at) => {
            let (before, document) = message.split_at(at);
            let said = ["Code", "Message"].iter().filter_map(|name| element(document, name));
            before.to_owned() + &said.collect::<Vec<_>>().join(": ")
        }
        None => message.to_owned(),
    };
    for secret in secrets.iter().filter(|secret| secret.len() >= SHORTEST_SECRET) {
        plain = plain.replace(secret.as_str(), "[hidden]");
    }
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The text of an element of a document.
fn element<'a>(document: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = document.split_once(&format!("<{name}>"))?;
    rest.split_once(&format!("</{name}>")).map(|(text, _)| text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reason_stays_and_the_key_does_not() {
        let message = "Generic S3 error: Server returned 403 Forbidden: <?xml version=\"1.0\"?>\n<Error><Code>SignatureDoesNotMatch</Code>\
                       <Message>The signature of AKIAEXAMPLE is wrong</Message><AWSAccessKeyId>AKIAEXAMPLE</AWSAccessKeyId>\
                       <StringToSign>AWS4-HMAC-SHA256</StringToSign></Error>";
        let plain = without_secrets(message, &["AKIAEXAMPLE".to_owned(), String::new()]);
        assert_eq!(
            plain,
            "Generic S3 error: Server returned 403 Forbidden: SignatureDoesNotMatch: The signature of [hidden] is wrong"
        );
        assert_eq!(
            without_secrets("no key AKIAEXAMPLE\nhere", &["AKIAEXAMPLE".to_owned()]),
            "no key [hidden] here"
        );
    }

    #[test]
    fn a_document_that_is_cut_off_is_left_out() {
        assert_eq!(
            without_secrets("refused: <Error><Code>Denied</Code><AWSAccessKeyId>AKIA", &[]),
            "refused: Denied"
        );
    }
}
