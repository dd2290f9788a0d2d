//! File browser for meshes and volumes.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use egui::{Align2, Area, Button, Context, Id, RichText, ScrollArea, Vec2};

use super::style;
use crate::window::opening;

/// The state of the browser: a folder and its entries.
#[derive(Debug)]
pub(super) struct Browser {
    folder: PathBuf,
    /// Folders first, then the files that can be opened.
    entries: Vec<FileEntry>,
    fault: Option<String>,
}

#[derive(Debug)]
struct FileEntry {
    name: String,
    path: PathBuf,
    is_folder: bool,
}

/// The result of a frame.
pub(super) enum BrowserAnswer {
    None,
    Closed,
    Chosen(PathBuf),
}

impl Browser {
    /// Opens a browser in the working directory.
    pub(super) fn new() -> Self {
        let folder = env::current_dir().unwrap_or_else(|_| "/".into());
        let mut browser = Browser { folder: PathBuf::new(), entries: Vec::new(), fault: None };
        browser.enter_folder(&folder);
        browser
    }

    pub(super) fn show(&mut self, context: &Context) -> BrowserAnswer {
        let area = Area::new(Id::new("browser")).anchor(Align2::CENTER_CENTER, Vec2::ZERO);
        let (mut answer, mut next) = (BrowserAnswer::None, None);
        area.show(context, |ui| {
            let frame = style::card_frame().inner_margin(22);
            let list_height = (style::largest_content_size(context, &frame).y - 130.0).min(360.0);
            style::show_within_window(ui, frame, 460.0, |ui| {
                ui.label(RichText::new("Open a mesh or a volume").size(19.0));
                ui.label(style::quiet_text(self.folder.display().to_string()).size(13.0));
                if let Some(fault) = &self.fault {
                    ui.label(RichText::new(fault).color(style::WARNING));
                }
                ui.horizontal(|ui| {
                    if ui.button("Up").clicked() {
                        next = self.folder.parent().map(Path::to_owned);
                    }
                    if ui.button("Cancel  (Esc)").clicked() {
                        answer = BrowserAnswer::Closed;
                    }
                });
                ScrollArea::vertical().max_height(list_height).show(ui, |ui| {
                    for FileEntry { name, path, is_folder } in &self.entries {
                        let text = if *is_folder { format!("{name}/") } else { name.clone() };
                        let color = if *is_folder { style::QUIET } else { style::TEXT };
                        let button = Button::new(RichText::new(text).color(color)).frame(false);
                        if ui.add(button).clicked() {
                            match is_folder {
                                true => next = Some(path.clone()),
                                false => answer = BrowserAnswer::Chosen(path.clone()),
                            }
                        }
                    }
                });
            });
        });
        if let Some(folder) = next {
            self.enter_folder(&folder);
        }
        answer
    }

    /// Shows a folder, or an error if it can't be read.
    fn enter_folder(&mut self, folder: &Path) {
        match list_folder(folder) {
            Ok(entries) => {
                *self = Browser { folder: folder.to_owned(), entries, fault: None };
            }
            Err(error) => self.fault = Some(format!("{}: {error}", folder.display())),
        }
    }
}

fn list_folder(folder: &Path) -> std::io::Result<Vec<FileEntry>> {
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder)? {
        let Ok(entry) = entry else { continue };
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        let is_folder = path.is_dir();
        if !name.starts_with('.') && (is_folder || opening::has_known_extension(&path)) {
            entries.push(FileEntry { name, path, is_folder });
        }
    }
    entries.sort_by(|a, b| (b.is_folder, &a.name).cmp(&(a.is_folder, &b.name)));
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::list_folder;

    #[test]
    fn only_what_can_be_opened_is_listed() {
        let folder = std::env::temp_dir().join(format!("paros-browser-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("zoo")).expect("a folder");
        for name in ["b.OBJ", "a.rmap", "notes.txt", ".hidden.stl"] {
            std::fs::write(folder.join(name), b"").expect("a file");
        }
        let entries = list_folder(&folder).expect("it can be read");
        let names: Vec<_> = entries.iter().map(|entry| &*entry.name).collect();
        assert_eq!(names, ["zoo", "a.rmap", "b.OBJ"]);
        assert!(list_folder(&folder.join("gone")).is_err());
        std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    }
}
