//! Closed forms.

mod verification;
