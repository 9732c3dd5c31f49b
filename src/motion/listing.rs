//! The manifests that cover the files of an import.

use super::error::{MotionError, MotionResult};
use super::files::name;
use super::manifest::{self, Entry, Manifest};
use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Entry as Slot};
use std::path::{Path, PathBuf};

/// The manifests of all folders of an import.
pub struct Listings<'a>(BTreeMap<&'a Path, Listing>);

impl<'a> Listings<'a> {
    /// Those that cover these files.
    ///
    /// # Errors
    /// A manifest with a mistake.
    pub fn of(files: &'a [PathBuf]) -> MotionResult<Listings<'a>> {
        let mut listings = BTreeMap::new();
        for file in files {
            if let Slot::Vacant(slot) = listings.entry(folder_of(file)) {
                slot.insert(Listing::beside(file)?);
            }
        }
        Ok(Listings(listings))
    }

    /// What is known about a file.
    pub fn entry(&self, file: &Path) -> Option<&Entry> {
        self.0.get(folder_of(file))?.entry(file)
    }

    /// One note for each table that only looks like a manifest.
    pub fn notes(&self) -> Vec<String> {
        let strangers = self.0.values().flat_map(|listing| &listing.strangers);
        let strangers: BTreeSet<&PathBuf> = strangers.collect();
        let note = |path: &PathBuf| {
            let path = path.display();
            format!(
                "{path} has no column `file`, so it is no manifest of recordings and was not read"
            )
        };
        strangers.into_iter().map(note).collect()
    }
}

fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// A manifest, and what it puts before the names of the folder's files.
#[derive(Default)]
struct Listing {
    manifest: Manifest,
    prefix: String,
    /// Tables of the manifest's name that are something else.
    strangers: Vec<PathBuf>,
}

impl Listing {
    /// The manifest in the file's folder, else the one above, else an empty one.
    ///
    /// # Errors
    /// A manifest with a mistake.
    fn beside(file: &Path) -> MotionResult<Listing> {
        let file = file.canonicalize().map_err(|error| MotionError::Read {
            path: file.to_path_buf(),
            error,
        })?;
        let mut listing = Listing::default();
        for folder in file.ancestors().skip(1).take(2) {
            let path = folder.join("manifest.csv");
            match manifest::read(&path)? {
                manifest::ManifestFile::Ours(manifest) => {
                    listing.manifest = manifest;
                    return Ok(listing);
                }
                manifest::ManifestFile::Stranger => listing.strangers.push(path),
                manifest::ManifestFile::Nothing => {}
            }
            listing.prefix = format!("{}/", name(folder));
        }
        Ok(listing)
    }

    /// What the manifest says of a file of the folder.
    fn entry(&self, file: &Path) -> Option<&Entry> {
        self.manifest.get(&format!("{}{}", self.prefix, name(file)))
    }
}
