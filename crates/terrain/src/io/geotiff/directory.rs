//! The directories of a TIFF: tags by number, as whatever type a writer gave them.

use std::{collections::BTreeSet, io::Cursor};

use tiff::{
    decoder::{Decoder, ifd::Value},
    tags::Tag,
};

use crate::Error;

/// Most directories that are walked: an image, 31 halvings of it (overviews) and a mask for each of them.
const MOST_DIRECTORIES: usize = 64;

/// Bit of NewSubfileType (TIFF 6.0, page 36): a smaller version of another image.
const REDUCED: u64 = 1;
/// Bit of NewSubfileType: a transparency mask of another image.
const MASK: u64 = 4;

/// A TIFF file whose directories have been found.
pub(super) struct TiffFile<'a> {
    /// The whole file.
    pub(super) bytes: &'a [u8],
    /// Whether its numbers begin with the most significant byte.
    pub(super) big_endian: bool,
    decoder: Decoder<Cursor<&'a [u8]>>,
    directories: Vec<tiff::Directory>,
}

impl<'a> TiffFile<'a> {
    /// Opens a file and walks its directories.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Error> {
        let mut decoder = Decoder::new(Cursor::new(bytes))?;
        let big_endian = bytes.starts_with(b"MM");
        let mut directories = Vec::new();
        let mut seen = BTreeSet::new();
        let mut next = decoder.ifd_pointer();
        while let Some(pointer) = next {
            if directories.len() == MOST_DIRECTORIES || !seen.insert(pointer.0) {
                break;
            }
            let directory = decoder.read_directory(pointer)?;
            next = directory.next();
            directories.push(directory);
        }
        Ok(TiffFile { bytes, big_endian, decoder, directories })
    }

    /// Position of the first image that is neither an overview nor a mask, and how many more of its kind there are.
    pub(super) fn main_image(&mut self) -> Result<(usize, usize), Error> {
        let mut images = Vec::new();
        for index in 0..self.directories.len() {
            if self.kind(index)? & (REDUCED | MASK) == 0 {
                images.push(index);
            }
        }
        match images.first() {
            Some(&first) => Ok((first, images.len() - 1)),
            None => Err(Error::TiffTag { tag: "image that is neither an overview nor a mask" }),
        }
    }

    /// The transparency masks of images in full size.
    pub(super) fn masks(&mut self) -> Result<Vec<usize>, Error> {
        let mut masks = Vec::new();
        for index in 0..self.directories.len() {
            if self.kind(index)? & (REDUCED | MASK) == MASK {
                masks.push(index);
            }
        }
        Ok(masks)
    }

    fn kind(&mut self, index: usize) -> Result<u64, Error> {
        Ok(self.tags(index).unsigned(Tag::NewSubfileType)?.unwrap_or(0))
    }

    /// The tags of a directory.
    pub(super) fn tags(&mut self, index: usize) -> Tags<'_, 'a> {
        Tags { file: self, index }
    }
}

/// The tags of one directory.
pub(super) struct Tags<'f, 'a> {
    file: &'f mut TiffFile<'a>,
    index: usize,
}

impl Tags<'_, '_> {
    fn value(&mut self, tag: Tag) -> Result<Option<Value>, Error> {
        let Some(directory) = self.file.directories.get(self.index) else { return Ok(None) };
        Ok(self.file.decoder.read_directory_tags(directory).find_tag(tag)?)
    }

    /// A whole number; the first where there are several.
    pub(super) fn unsigned(&mut self, tag: Tag) -> Result<Option<u64>, Error> {
        Ok(self.unsigned_list(tag)?.first().copied())
    }

    /// Whole numbers, none where there is no such tag.
    pub(super) fn unsigned_list(&mut self, tag: Tag) -> Result<Vec<u64>, Error> {
        Ok(self.value(tag)?.map(Value::into_u64_vec).transpose()?.unwrap_or_default())
    }

    /// Numbers in double precision.
    pub(super) fn doubles(&mut self, tag: Tag) -> Result<Option<Vec<f64>>, Error> {
        Ok(self.value(tag)?.map(Value::into_f64_vec).transpose()?)
    }

    /// Text without the zero bytes and spaces around it; bytes that are no UTF-8 are replaced.
    pub(super) fn text(&mut self, tag: Tag) -> Result<Option<String>, Error> {
        let Some(directory) = self.file.directories.get(self.index) else { return Ok(None) };
        let mut buffer = tiff::tags::ValueBuffer::empty(tiff::tags::Type::BYTE);
        let found = self.file.decoder.read_directory_tags(directory).find_tag_buf(tag, &mut buffer)?;
        let text = || String::from_utf8_lossy(buffer.as_bytes()).into_owned();
        Ok(found.map(|_| text().trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned()))
    }
}
