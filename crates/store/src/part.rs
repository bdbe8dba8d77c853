//! One of several workers on the same run: it reads what all have done together, and keeps what it does itself apart.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

use super::database::{STORE_FILE, Store};
use super::fingerprint::Fingerprint;
use super::lock::Place;
use super::row::Table;
use super::share::Share;
use super::storage::Storage;
use super::trial::Trial;
use realgap_core::error::Result;

/// Rows that all workers have done together, which are read, and those of one of them, which are kept in a store of its own.
/// Without a worker it takes nothing: whoever only asks what is missing.
#[derive(Debug)]
pub struct Part<R = Trial> {
    merged: Option<Store<R>>,
    own: Option<(Store<R>, Share)>,
    /// Rows that the run asked for at last.
    asked: usize,
}

impl<R: Table> Part<R> {
    /// Of the run in the folder `merged`, which may not hold anything yet, for looking.
    ///
    /// # Errors
    /// Results of another run there, or damaged ones.
    pub fn look(merged: &Path, fingerprint: &Fingerprint) -> Result<Self> {
        let merged = if merged.join(STORE_FILE).exists() {
            let store = Store::read(merged)?;
            store.must_be_of(fingerprint)?;
            Some(store)
        } else {
            None
        };
        Ok(Self {
            merged,
            own: None,
            asked: 0,
        })
    }

    /// Of the run in the folder `merged`, with a worker's own rows in a folder of their own, where it goes on if it was stopped
    /// before.
    ///
    /// # Errors
    /// As [`Part::look`]; an own folder that is in use, cannot be written or holds rows of another run.
    pub fn open<'a>(
        merged: &Path,
        own: impl Into<Place<'a>>,
        share: Share,
        fingerprint: &Fingerprint,
    ) -> Result<Self> {
        let store = Store::go_on(own.into().lock()?, fingerprint)?;
        Ok(Self {
            own: Some((store, share)),
            ..Self::look(merged, fingerprint)?
        })
    }

    /// How many rows the run asked for at last: all of the batch that is under way, and of those before it.
    pub fn asked(&self) -> usize {
        self.asked
    }

    /// Indices of the rows that were asked for and are neither merged nor here.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn missing(&self) -> Result<Vec<usize>> {
        let finished = self.finished()?;
        Ok((0..self.asked)
            .filter(|index| !finished.contains(index))
            .collect())
    }

    /// Notes whether the worker has done all that is its of what was asked for, and says how many rows it has not.
    ///
    /// # Errors
    /// A store that cannot be written.
    pub fn close(&mut self) -> Result<usize> {
        let missing = self.missing()?;
        let Some((store, share)) = &mut self.own else {
            return Ok(missing.len());
        };
        let left = missing.iter().filter(|index| share.has(**index)).count();
        if left == 0 && !store.is_complete()? {
            store.complete()?;
        }
        Ok(left)
    }
}

impl<R: Table> Storage<R> for Part<R> {
    fn finished(&self) -> Result<BTreeSet<usize>> {
        let mut all = match &self.merged {
            Some(merged) => merged.finished()?,
            None => BTreeSet::new(),
        };
        if let Some((own, _)) = &self.own {
            all.extend(own.finished()?);
        }
        Ok(all)
    }

    fn insert(&mut self, rows: &[R]) -> Result<()> {
        match &mut self.own {
            Some((own, _)) => own.insert(rows),
            None => Ok(()),
        }
    }

    fn rows_within(&self, range: Range<usize>) -> Result<Vec<R>> {
        let mut rows = match &self.merged {
            Some(merged) => merged.rows_within(range.clone())?,
            None => Vec::new(),
        };
        if let Some((own, _)) = &self.own {
            let known: BTreeSet<usize> = rows.iter().map(R::index).collect();
            let more = own.rows_within(range)?;
            rows.extend(more.into_iter().filter(|row| !known.contains(&row.index())));
            rows.sort_by_key(R::index);
        }
        Ok(rows)
    }

    fn begin(&mut self, rows: usize) {
        self.asked = rows;
    }

    fn takes(&self, index: usize) -> bool {
        match &self.own {
            Some((_, share)) => share.has(index),
            None => false,
        }
    }
}
