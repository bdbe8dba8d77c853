//! The pages of a Parquet file, also those that are compressed with zstd.
//!
//! The crate `parquet` unpacks zstd with a library in C. Here it is told that such pages are not compressed, and what it returns is
//! unpacked by a decoder in Rust.

use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::Compression;
use parquet::bloom_filter::Sbbf;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::reader::RowGroupReader;
use parquet::file::serialized_reader::SerializedPageReader;
use parquet::record::reader::RowIter;
use parquet::schema::types::Type;

use realgap_core::file::read_zstd;

/// The largest page, unpacked: writers make pages of about 1 MB.
const MOST_IN_PAGE: u64 = 64_000_000;

/// The rows of one group of a file.
pub(super) struct Group<'a> {
    file: Arc<Bytes>,
    metadata: &'a RowGroupMetaData,
}

impl<'a> Group<'a> {
    pub fn new(file: Bytes, metadata: &'a RowGroupMetaData) -> Self {
        Self {
            file: Arc::new(file),
            metadata,
        }
    }
}

impl RowGroupReader for Group<'_> {
    fn metadata(&self) -> &RowGroupMetaData {
        self.metadata
    }

    fn num_columns(&self) -> usize {
        self.metadata.num_columns()
    }

    fn get_column_page_reader(&self, index: usize) -> Result<Box<dyn PageReader>> {
        let column = self.metadata.column(index);
        let rows = usize::try_from(self.metadata.num_rows())?;
        let pages = |column| SerializedPageReader::new(Arc::clone(&self.file), column, rows, None);
        if !matches!(column.compression(), Compression::ZSTD(_)) {
            return Ok(Box::new(pages(column)?));
        }
        let packed = column.clone().into_builder();
        let packed = packed.set_compression(Compression::UNCOMPRESSED).build()?;
        Ok(Box::new(Unpacked(pages(&packed)?)))
    }

    fn get_column_bloom_filter(&self, _index: usize) -> Option<&Sbbf> {
        None
    }

    fn get_row_iter(&self, projection: Option<Type>) -> Result<RowIter<'_>> {
        RowIter::from_row_group(projection, self)
    }
}

/// Pages that are unpacked after they were read.
struct Unpacked(SerializedPageReader<Bytes>);

impl Iterator for Unpacked {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for Unpacked {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        self.0.get_next_page()?.map(unpacked).transpose()
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.0.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.0.skip_next_page()
    }
}

fn unpacked(mut page: Page) -> Result<Page> {
    match &mut page {
        Page::DataPage { buf, .. } | Page::DictionaryPage { buf, .. } => *buf = unpack(buf, 0)?,
        Page::DataPageV2 {
            buf,
            def_levels_byte_len,
            rep_levels_byte_len,
            is_compressed: true,
            ..
        } => {
            // The levels before the values are never compressed.
            let levels = u64::from(*def_levels_byte_len) + u64::from(*rep_levels_byte_len);
            *buf = unpack(buf, usize::try_from(levels)?)?;
        }
        Page::DataPageV2 { .. } => {}
    }
    Ok(page)
}

/// Unpacks what follows behind the first bytes; nothing is an empty page.
fn unpack(packed: &Bytes, plain: usize) -> Result<Bytes> {
    let refused =
        || ParquetError::General("a page of zstd that is damaged, or larger than 64 MB".to_owned());
    let (levels, values) = packed.split_at_checked(plain).ok_or_else(refused)?;
    let mut all = levels.to_vec();
    if !values.is_empty() {
        all.extend(read_zstd(values, MOST_IN_PAGE).ok_or_else(refused)?);
    }
    Ok(Bytes::from(all))
}
