//! Limits attempts to guess the token, over all clients.

use super::bucket::Bucket;
use super::guard::{Refusal, TOKEN_LENGTHS, Token};
use hyper::StatusCode;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Number of different wrong tokens that may be tried at once, and per second in the long run.
const AT_ONCE: u32 = 5;
const PER_S: f64 = 0.5;
/// Number of wrong tokens that are remembered and not counted again. A page that was left open repeats its old
/// token, which is not a guess.
const REMEMBERED: usize = 64;

const NO_TOKEN: Refusal =
    (StatusCode::UNAUTHORIZED, "this needs the token that was printed when the server started\n");
const TOO_MANY: Refusal = (StatusCode::TOO_MANY_REQUESTS, "too many tokens were tried: wait some seconds\n");

/// The attempts of all clients to show the token.
#[derive(Debug)]
pub struct Trials(Mutex<TrialLog>);

#[derive(Debug)]
struct TrialLog {
    bucket: Bucket,
    wrong: VecDeque<String>,
}

impl Trials {
    pub fn new(now: Instant) -> Self {
        Self(Mutex::new(TrialLog { bucket: Bucket::new(AT_ONCE, PER_S, now), wrong: VecDeque::new() }))
    }

    /// Checks whether one of the texts `shown` is the token. After too many attempts, even the right token is refused
    /// for some seconds, since the answer would confirm a guess.
    pub fn admit<'a>(
        &self,
        token: &Token,
        shown: impl IntoIterator<Item = &'a str>,
        now: Instant,
    ) -> Result<(), Refusal> {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for shown in shown {
            if log.is(token, shown, now)? {
                return Ok(());
            }
        }
        Err(NO_TOKEN)
    }
}

impl TrialLog {
    fn is(&mut self, token: &Token, shown: &str, now: Instant) -> Result<bool, Refusal> {
        if !TOKEN_LENGTHS.contains(&shown.len()) || self.wrong.iter().any(|wrong| wrong == shown) {
            return Ok(false);
        }
        if !self.bucket.has_one(now) {
            return Err(TOO_MANY);
        }
        if token.is(shown) {
            return Ok(true);
        }
        // this cannot fail, because `has_one` was true
        let _ = self.bucket.take(now);
        if self.wrong.len() == REMEMBERED {
            self.wrong.pop_front();
        }
        self.wrong.push_back(shown.to_owned());
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn wrong(k: u32) -> String {
        format!("{k:032}")
    }

    #[test]
    fn after_many_wrong_tokens_the_right_one_waits_as_well() {
        let (began, token) = (Instant::now(), Token::random().unwrap());
        let (trials, right) = (Trials::new(began), token.reveal());
        let status = |shown: &str, at_s: u64| {
            trials.admit(&token, [shown], began + Duration::from_secs(at_s)).err().map(|(status, _)| status.as_u16())
        };
        // the right token, an impossible token and a repeated wrong token do not count as attempts
        assert!((0..100).all(|_| status(right, 0).is_none() && status("0", 0) == Some(401)));
        assert!((0..100).all(|_| status(&wrong(0), 0) == Some(401)));
        assert!((1..5).all(|k| status(&wrong(k), 0) == Some(401)));
        assert_eq!([status(&wrong(5), 0), status(right, 0), status(&wrong(0), 0)], [Some(429), Some(429), Some(401)]);
        assert_eq!([status(right, 2), status(&wrong(5), 2), status(right, 2)], [None, Some(401), Some(429)]);
    }

    #[test]
    fn each_token_of_a_request_counts() {
        let (began, token) = (Instant::now(), Token::random().unwrap());
        let many: Vec<String> = (0..100).map(wrong).chain([token.reveal().to_owned()]).collect();
        let refused = Trials::new(began).admit(&token, many.iter().map(String::as_str), began).unwrap_err();
        assert_eq!(refused.0, StatusCode::TOO_MANY_REQUESTS);
        assert_eq!(Trials::new(began).admit(&token, [], began).unwrap_err().0, StatusCode::UNAUTHORIZED);
    }
}
