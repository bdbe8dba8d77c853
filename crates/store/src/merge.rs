//! Merges the rows of several workers into one store.

use std::collections::BTreeSet;
use std::path::Path;

use rusqlite::OptionalExtension as _;

use super::connection::sql;
use super::database::{Store, commit};
use super::fingerprint::Fingerprint;
use super::lock::Place;
use super::row::Table;
use super::trial::Trial;
use realgap_core::error::{Error, Result};

/// A store into which the rows of other stores are copied.
///
/// ```
/// use realgap_store::{Fingerprint, Merger, Store, Trial};
///
/// let folder = std::env::temp_dir().join(format!("realgap-merge-{}", std::process::id()));
/// let print = Fingerprint::new().with("study", "mine");
/// for index in 0..2 {
///     let mut part = Store::create(&folder.join(index.to_string()), &print)?;
///     part.insert(&[Trial { index, values: vec![0.5], cases: Vec::new() }])?;
/// }
/// let mut merger: Merger = Merger::open(&folder.join("whole"), &print)?;
/// assert_eq!(merger.absorb(&folder.join("1"))?.new, 1);
/// assert_eq!(merger.absorb(&folder.join("0"))?.new, 1);
/// assert_eq!(merger.absorb(&folder.join("0"))?.known, 1);
/// assert_eq!(merger.rows(), 2);
/// # drop(merger);
/// # std::fs::remove_dir_all(&folder).expect("it was just made");
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug)]
pub struct Merger<R = Trial> {
    store: Store<R>,
    known: BTreeSet<usize>,
}

/// The number of rows that were copied from one store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Absorbed {
    /// Rows that were new.
    pub new: usize,
    /// Rows that were there already with the same bits.
    pub known: usize,
}

impl<R: Table> Merger<R> {
    /// Opens the store in a folder to merge other stores into it; a new store if the folder has none.
    ///
    /// # Errors
    /// A folder that cannot be written, is in use or holds results of another run.
    pub fn open<'a>(place: impl Into<Place<'a>>, fingerprint: &Fingerprint) -> Result<Self> {
        let store = Store::go_on(place.into().lock()?, fingerprint)?;
        let known = store.finished()?;
        Ok(Self { store, known })
    }

    /// The number of rows in the merged store.
    pub fn rows(&self) -> usize {
        self.known.len()
    }

    /// Copies the rows of the store in `folder`, either all of them or none. Each row is compared with its checksum, and a row that is
    /// already in the merged store is compared with the one there.
    ///
    /// # Errors
    /// No store in `folder`, a damaged store, a store of another run; a row that differs from the row in the merged store; a full disk.
    pub fn absorb(&mut self, folder: &Path) -> Result<Absorbed> {
        let part = Store::<R>::look(folder)?;
        part.must_be_of(&self.store.fingerprint()?)?;
        let path = self.store.path.clone();
        let mut tally = self.store.tally;
        let write = |e: rusqlite::Error| sql(&path, "write the results", &e);
        let transaction = self.store.connection.transaction().map_err(write)?;
        let query = format!("SELECT checksum FROM {} WHERE id = ?1", R::NAME);
        let mut absorbed = Absorbed::default();
        let mut new = Vec::new();
        part.each_verified(|row, checksum| {
            if !self.known.contains(&row.index()) {
                tally.add(row.insert(&transaction).map_err(write)?);
                new.push(row.index());
                return Ok(());
            }
            let there: Option<i64> = transaction
                .prepare_cached(&query)
                .and_then(|mut query| {
                    query
                        .query_row([row.index() as i64], |row| row.get(0))
                        .optional()
                })
                .map_err(write)?;
            if there != Some(checksum) {
                return Err(disagree::<R>(&part, row.index(), &path));
            }
            absorbed.known += 1;
            Ok(())
        })?;
        let both = [self.store.tally, tally];
        commit(transaction, self.store.writer.as_mut(), both, write)?;
        self.store.tally = tally;
        absorbed.new = new.len();
        self.known.extend(new);
        Ok(absorbed)
    }
}

fn disagree<R: Table>(part: &Store<R>, index: usize, other: &Path) -> Error {
    Error::conflict("two results of the same work differ")
        .at_file(&part.path)
        .found(format!("another {} {index} than in {}", R::NAME, other.display()))
        .allowed("the same bits")
        .hint("one of the two machines computes differently: compare their processors and system libraries, and run the shard again on the machine that you trust")
}
