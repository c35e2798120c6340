//! The pages of a column, checked before they are decoded: that a page is as long as it says, and that the dictionary is there that it
//! refers to. The decoder does not check this.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::chunk::LONGEST_RECORD;
use super::header::LARGEST_PAGE;
use ::bytes::Bytes;
use ::parquet::basic::{Encoding, Type as Physical};
use ::parquet::column::page::{Page, PageMetadata, PageReader};
use ::parquet::errors::{ParquetError, Result};
use ::parquet::schema::types::ColumnDescriptor;

/// The lengths of the texts that are read.
#[derive(Default)]
pub(super) struct Texts {
    /// Bytes of the longest text.
    longest: AtomicUsize,
    /// Bytes of the pages for the rows that are read together.
    together: AtomicUsize,
}

impl Texts {
    /// Begins with the next rows. Returns the length of the longest text so far.
    pub(super) fn begin(&self) -> usize {
        self.together.store(0, Ordering::Relaxed);
        self.longest.load(Ordering::Relaxed)
    }
}

/// Bytes of a text at most: as many as a row of a text may have.
const LONGEST_TEXT: usize = LONGEST_RECORD;
/// Bytes of unpacked pages of texts at most, for the rows that are read together.
const MOST_TOGETHER: usize = 2 * LARGEST_PAGE;

/// Pages that can be decoded.
pub(super) struct CheckedPages {
    pages: Box<dyn PageReader>,
    /// Whether the column's values are texts.
    is_text: bool,
    /// Whether a row can be without a value.
    is_optional: bool,
    has_dictionary: bool,
    texts: Arc<Texts>,
    /// The dictionary, which is read first.
    dictionary: Option<Page>,
}

impl CheckedPages {
    /// The pages of a column. The dictionary of a column of texts is read at once, so that the lengths of its texts are known.
    pub(super) fn new(pages: Box<dyn PageReader>, column: &ColumnDescriptor, texts: &Arc<Texts>) -> Result<Self> {
        let is_text = column.physical_type() == Physical::BYTE_ARRAY;
        let is_optional = column.max_def_level() > 0;
        let texts = Arc::clone(texts);
        let mut pages = Self { pages, is_text, is_optional, has_dictionary: false, texts, dictionary: None };
        if is_text && pages.pages.peek_next_page()?.is_some_and(|page| page.is_dict) {
            pages.dictionary = pages.next_page()?;
        }
        Ok(pages)
    }

    fn next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        page.map(|page| self.checked(page)).transpose()
    }

    /// Checks that a page holds all that it promises, and gives texts an end that the decoder notices.
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
                // the decoder does not check their lengths, and ends the program where they are wrong
                return Err(broken(&format!("a column is {}", packed_by_differences(page.encoding()))));
            }
            _ => page.encoding() == Encoding::PLAIN,
        };
        if self.is_text && is_plain {
            let (Page::DictionaryPage { buf, .. } | Page::DataPage { buf, .. } | Page::DataPageV2 { buf, .. }) =
                &mut page;
            let (ended, longest) = ended(buf, start).ok_or_else(|| broken("a text is longer than its page"))?;
            let together = self.texts.together.fetch_add(buf.len(), Ordering::Relaxed) + buf.len();
            if longest > LONGEST_TEXT || together > MOST_TOGETHER {
                let (one, all) = (LONGEST_TEXT >> 10, MOST_TOGETHER >> 20);
                return Err(broken(&format!(
                    "a text is longer than {one} KiB, or the texts of some rows than {all} MiB"
                )));
            }
            self.texts.longest.fetch_max(longest, Ordering::Relaxed);
            *buf = ended;
        }
        Ok(page)
    }

    /// Where the values begin: behind the levels, which say which rows have a value.
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

/// A packing of texts that is not read, in words.
pub(super) fn packed_by_differences(encoding: Encoding) -> String {
    format!("packed by {encoding}, which is not read")
}

fn broken(problem: &str) -> ParquetError {
    ParquetError::General(problem.to_owned())
}

fn is_dictionary(encoding: Encoding) -> bool {
    matches!(encoding, Encoding::RLE_DICTIONARY | Encoding::PLAIN_DICTIONARY)
}

/// The end of a text whose length stands before it, in four bytes at `at`.
fn behind_length(bytes: &[u8], at: usize) -> Option<usize> {
    let start = at.checked_add(4)?;
    let length = u32::from_le_bytes(bytes.get(at..start)?.try_into().ok()?);
    start.checked_add(usize::try_from(length).ok()?)
}

/// A page whose texts begin at `start`, with a length behind them that no text has and that stops the decoder; and the length of the
/// longest text. `None` if the texts do not fill the page.
fn ended(page: &[u8], start: usize) -> Option<(Bytes, usize)> {
    let (mut at, mut longest) = (start, 0);
    while at < page.len() {
        let end = behind_length(page, at)?;
        (at, longest) = (end, longest.max(end - at - 4));
    }
    (at == page.len()).then(|| ([page, &[0xff; 4]].concat().into(), longest))
}

impl Iterator for CheckedPages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for CheckedPages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        match self.dictionary.take() {
            Some(page) => Ok(Some(page)),
            None => self.next_page(),
        }
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        match self.dictionary {
            Some(_) => Ok(Some(PageMetadata { num_rows: None, num_levels: None, is_dict: true })),
            None => self.pages.peek_next_page(),
        }
    }

    fn skip_next_page(&mut self) -> Result<()> {
        if self.dictionary.take().is_some() { Ok(()) } else { self.pages.skip_next_page() }
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.pages.at_record_boundary()
    }
}
