//! The files of a log inside a recording, so that one file is enough to replay it.

use super::RecordingError;
use super::source::files;
use mcap::{Attachment, Summary, read::attachment};
use std::borrow::Cow;
use std::fs;
use std::path::{Component, Path};

/// Endings of files that are attached, and their media types.
const KINDS: [(&str, &str); 5] = [
    ("csv", "text/csv"),
    ("json", "application/json"),
    ("toml", "application/toml"),
    ("png", "image/png"),
    ("jpg", "image/jpeg"),
];

/// Tables, descriptions and pictures in a directory and its folders, sorted by their names, which
/// are paths from the directory with `/`.
pub fn attached(directory: &Path) -> Result<Vec<Attachment<'static>>, RecordingError> {
    let mut attachments = Vec::new();
    for path in files(directory)? {
        let kind = KINDS.iter().find(|(ending, _)| {
            let found = path.extension();
            found.is_some_and(|found| found.eq_ignore_ascii_case(ending))
        });
        // Names of logs are plain text; others belong to the user.
        let name = path.strip_prefix(directory).ok().and_then(Path::to_str);
        if let (Some((_, media_type)), Some(name)) = (kind, name) {
            attachments.push(Attachment {
                log_time: 0,
                create_time: 0,
                name: name.replace(std::path::MAIN_SEPARATOR, "/"),
                media_type: (*media_type).to_owned(),
                data: Cow::Owned(fs::read(&path).map_err(RecordingError::at(&path))?),
            });
        }
    }
    attachments.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(attachments)
}

/// Writes the attached files of a recording into a directory.
///
/// # Errors
/// The recording is damaged or has no attachments, a name leads out of the directory, or a file
/// cannot be written.
pub fn unpack(recording: &Path, directory: &Path) -> Result<(), RecordingError> {
    let file = fs::read(recording).map_err(RecordingError::at(recording))?;
    let damaged = |error| RecordingError::Recording {
        path: recording.to_owned(),
        error,
    };
    let summary = Summary::read(&file).map_err(damaged)?;
    let indexes = summary.map_or_else(Vec::new, |summary| summary.attachment_indexes);
    if indexes.is_empty() {
        return Err(RecordingError::NoAttachments(recording.to_owned()));
    }
    for index in &indexes {
        let attached = attachment(&file, index).map_err(damaged)?;
        let name = Path::new(&attached.name);
        let stays_inside = name
            .components()
            .all(|component| matches!(component, Component::Normal(_)));
        if !stays_inside {
            return Err(RecordingError::AttachmentName {
                path: recording.to_owned(),
                name: attached.name,
            });
        }
        let to = directory.join(name);
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder).map_err(RecordingError::at(folder))?;
        }
        fs::write(&to, &attached.data).map_err(RecordingError::at(&to))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::Writer;

    fn write(path: &Path, attachments: &[Attachment]) {
        let mut writer = Writer::new(fs::File::create(path).unwrap()).unwrap();
        for attachment in attachments {
            writer.attach(attachment).unwrap();
        }
        writer.finish().unwrap();
    }

    #[test]
    fn attached_files_come_back() {
        let directory = tempfile::tempdir().unwrap();
        let log = directory.path().join("log");
        fs::create_dir_all(log.join("laying/arm")).unwrap();
        for (name, text) in [
            ("manifest.json", "{}"),
            ("laying/arm/state.csv", "time_s\n"),
            ("picture.PNG", "picture"),
            ("view.html", "page"),
        ] {
            fs::write(log.join(name), text).unwrap();
        }
        let attachments = attached(&log).unwrap();
        let names: Vec<_> = attachments.iter().map(|file| &file.name[..]).collect();
        assert_eq!(
            names,
            ["laying/arm/state.csv", "manifest.json", "picture.PNG"]
        );
        let recording = directory.path().join("log.mcap");
        write(&recording, &attachments);
        let back = directory.path().join("back");
        unpack(&recording, &back).unwrap();
        assert_eq!(attached(&back).unwrap(), attachments);
    }

    #[test]
    fn names_that_lead_out_of_the_directory_are_rejected() {
        let directory = tempfile::tempdir().unwrap();
        let recording = directory.path().join("log.mcap");
        let back = directory.path().join("back");
        let fault = || unpack(&recording, &back).unwrap_err().to_string();
        for name in ["../a.csv", "/tmp/a.csv", "a/../../b.csv"] {
            let attachment = Attachment {
                log_time: 0,
                create_time: 0,
                name: name.to_owned(),
                media_type: String::new(),
                data: Cow::Borrowed(b"a"),
            };
            write(&recording, &[attachment]);
            assert!(fault().contains(name), "{}", fault());
        }
        write(&recording, &[]);
        assert!(fault().contains("no attached files"), "{}", fault());
        fs::write(&recording, "text").unwrap();
        assert!(fault().contains("log.mcap: "), "{}", fault());
        assert!(!directory.path().join("a.csv").exists());
    }
}
