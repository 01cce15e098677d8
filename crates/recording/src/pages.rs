//! Pages of a Parquet column, held against their own bytes.

use parquet::{
    column::page::{Page, PageMetadata, PageReader},
    errors::{ParquetError, Result},
};

/// Refuses a dictionary that claims more values than it has bytes: room for all that it claims would be taken at once, and a
/// header of twenty bytes can claim four thousand million.
pub(crate) struct Pages {
    pub(crate) source: Box<dyn PageReader>,
    /// Of the column, for messages.
    pub(crate) name: String,
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.source.get_next_page().map_err(|error| self.of_column(error))?;
        match &page {
            Some(Page::DictionaryPage { buf, num_values, .. }) if *num_values as usize > buf.len() => {
                let reason = format!(
                    "the dictionary of column `{}` says to hold {num_values} values in {} bytes",
                    self.name,
                    buf.len()
                );
                Err(ParquetError::General(reason))
            }
            _ => Ok(page),
        }
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.source.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.source.skip_next_page()
    }
}

impl Pages {
    /// What the library refuses, with the column: a page that fails its checksum holds numbers that nobody recorded.
    fn of_column(&self, error: ParquetError) -> ParquetError {
        match error {
            ParquetError::General(reason) if reason.contains("CRC") => ParquetError::General(format!(
                "a page of column `{}` fails its checksum, so that its numbers are not those that were written: copy the file again",
                self.name
            )),
            other => other,
        }
    }
}

impl Iterator for Pages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Result<Page>> {
        self.get_next_page().transpose()
    }
}
