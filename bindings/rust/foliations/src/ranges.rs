//! Ranges of options. The library takes 0 for the default, which here is an option that is not set.

use crate::error::{Error, Result};

/// The first option that was set out of its range, for the call that uses it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Refusal(Option<Error>);

impl Refusal {
    /// `range`: "[0.05, 0.95]", with round brackets where an end is left out.
    pub(crate) fn check(&mut self, name: &str, value: f64, range: &str) {
        let (low, high) = range[1..range.len() - 1].split_once(", ").expect("two ends");
        let end = |word: &str| word.parse::<f64>().expect("a number");
        let above = if range.starts_with('(') { value > end(low) } else { value >= end(low) };
        let below = if range.ends_with(')') { value < end(high) } else { value <= end(high) };
        if !(above && below) {
            let message = format!("{name}: {value} is not in {range}. Leave it out for the default.");
            self.0.get_or_insert_with(|| Error::option(message));
        }
    }

    pub(crate) fn result(&self) -> Result<()> {
        self.0.clone().map_or(Ok(()), Err)
    }
}
