//! The pages of a column, checked before they are decoded. Stands between the file and the decoder, which takes it for
//! granted that a page is as long as it says and has the dictionary that it refers to.

use ::bytes::Bytes;
use ::parquet::basic::{Encoding, Type as Physical};
use ::parquet::column::page::{Page, PageMetadata, PageReader};
use ::parquet::errors::{ParquetError, Result};
use ::parquet::schema::types::ColumnDescriptor;

/// Pages that can be decoded.
pub(super) struct CheckedPages {
    pages: Box<dyn PageReader>,
    /// Whether the column's values are texts.
    is_text: bool,
    /// Whether a row can be without a value.
    is_optional: bool,
    has_dictionary: bool,
}

impl CheckedPages {
    pub(super) fn new(pages: Box<dyn PageReader>, column: &ColumnDescriptor) -> Self {
        let is_text = column.physical_type() == Physical::BYTE_ARRAY;
        Self { pages, is_text, is_optional: column.max_def_level() > 0, has_dictionary: false }
    }

    /// Whether the decoder finds all that a page promises; texts get an end that it notices.
    fn checked(&mut self, mut page: Page) -> Result<Page> {
        let start = self.values_start(&page).filter(|start| *start <= page.buffer().len());
        let start = start.ok_or_else(|| broken("a page is shorter than it says"))?;
        let is_plain = match page {
            Page::DictionaryPage { .. } => {
                self.has_dictionary = true;
                true
            }
            _ if is_dictionary(page.encoding()) && !self.has_dictionary => {
                return Err(broken("a page refers to a dictionary that is not there"));
            }
            _ if matches!(page.encoding(), Encoding::DELTA_BYTE_ARRAY | Encoding::DELTA_LENGTH_BYTE_ARRAY) => {
                // the decoder takes their lengths for granted, and ends the program where they are wrong
                return Err(broken(&format!("a column is {}", packed_by_differences(page.encoding()))));
            }
            _ => page.encoding() == Encoding::PLAIN,
        };
        if self.is_text && is_plain {
            let (Page::DictionaryPage { buf, .. } | Page::DataPage { buf, .. } | Page::DataPageV2 { buf, .. }) =
                &mut page;
            *buf = ended(buf, start).ok_or_else(|| broken("a text is longer than its page"))?;
        }
        Ok(page)
    }

    /// Where the values begin: behind what says which rows have one.
    fn values_start(&self, page: &Page) -> Option<usize> {
        #[expect(deprecated, reason = "older files have it")]
        let packed = Encoding::BIT_PACKED;
        match page {
            Page::DictionaryPage { .. } => Some(0),
            Page::DataPage { .. } if !self.is_optional => Some(0),
            Page::DataPage { def_level_encoding, num_values, .. } if *def_level_encoding == packed => {
                usize::try_from(num_values.div_ceil(8)).ok()
            }
            Page::DataPage { buf, .. } => behind_length(buf, 0),
            Page::DataPageV2 { def_levels_byte_len, rep_levels_byte_len, .. } => {
                usize::try_from(def_levels_byte_len.checked_add(*rep_levels_byte_len)?).ok()
            }
        }
    }
}

/// Texts whose packing is not read.
pub(super) fn packed_by_differences(encoding: Encoding) -> String {
    format!("packed by differences ({encoding}), which is not read")
}

fn broken(problem: &str) -> ParquetError {
    ParquetError::General(problem.to_owned())
}

fn is_dictionary(encoding: Encoding) -> bool {
    matches!(encoding, Encoding::RLE_DICTIONARY | Encoding::PLAIN_DICTIONARY)
}

/// The end of what has its length before it, in four bytes at `at`.
fn behind_length(bytes: &[u8], at: usize) -> Option<usize> {
    let start = at.checked_add(4)?;
    let length = u32::from_le_bytes(bytes.get(at..start)?.try_into().ok()?);
    start.checked_add(usize::try_from(length).ok()?)
}

/// A page of texts from `start` on, and at its end a length that no text has: whoever reads beyond the end finds it.
/// `None` if the texts do not fill the page.
fn ended(page: &[u8], start: usize) -> Option<Bytes> {
    let mut at = start;
    while at < page.len() {
        at = behind_length(page, at)?;
    }
    (at == page.len()).then(|| [page, &[0xff; 4]].concat().into())
}

impl Iterator for CheckedPages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for CheckedPages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        page.map(|page| self.checked(page)).transpose()
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.pages.at_record_boundary()
    }
}
