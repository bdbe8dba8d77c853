//! The storage of one of several workers on the same run: it reads the merged rows of all workers, and stores its own rows separately.

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

/// The merged rows of all workers, which are only read, and the rows of one worker, which are stored in its own store.
/// Without an own store it computes no rows; it then only tells which rows are missing.
#[derive(Debug)]
pub struct Part<R = Trial> {
    merged: Option<Store<R>>,
    own: Option<(Store<R>, Share)>,
    /// The number of rows that the run requested last.
    asked: usize,
}

impl<R: Table> Part<R> {
    /// Opens the run in the folder `merged`, which may still be empty, for reading only.
    ///
    /// # Errors
    /// Results of another run in the folder, or damaged results.
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

    /// Opens the run in the folder `merged`, with the worker's own rows in the folder `own`, where a worker that was stopped before
    /// continues.
    ///
    /// # Errors
    /// The errors of [`Part::look`]; an own folder that is in use, cannot be written or holds rows of another run.
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

    /// The number of rows that the run requested last: those of the present batch and of all earlier batches.
    pub fn asked(&self) -> usize {
        self.asked
    }

    /// Indices of the requested rows that are neither in the merged store nor in the own store.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn missing(&self) -> Result<Vec<usize>> {
        let finished = self.finished()?;
        Ok((0..self.asked)
            .filter(|index| !finished.contains(index))
            .collect())
    }

    /// Marks the own store as complete if the worker has computed all requested rows of its share, and returns the number of rows of its
    /// share that are missing.
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
