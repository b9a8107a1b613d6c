//! `rodlab run --watch`: the 3-D page of a run, rewritten while the run is in progress.

use super::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use rodlab_files::results::PAGE;
use rodlab_lab::report::{ViewError, WrittenPage, write_page_that_reloads};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Largest number of outputs on the page, which is read repeatedly.
const OUTPUTS: usize = 1000;
/// Least time between two pages.
const PERIOD: Duration = Duration::from_secs(3);
/// Least ratio of the time between two pages to the time that writing one takes, so that the run
/// keeps most of the processor time.
const PATIENCE: u32 = 20;
/// Time between two attempts to write the first page.
const FIRST: Duration = Duration::from_millis(500);

/// Writes the page of a results directory until it is dropped. The last page does not reload
/// itself.
pub struct Watch {
    end: Option<Sender<()>>,
    writer: Option<JoinHandle<()>>,
}

impl Watch {
    /// Starts to write the page of a directory, and opens it in the browser. The directory need
    /// not exist yet.
    pub fn start(directory: &Path) -> Result<Self, Failure> {
        let fault =
            |error: &dyn Display| Failure::System(format!("cannot start a thread: {error}"));
        let (end, ended) = channel();
        // The common thread pool is used by the run; if it has a single thread, it is busy until
        // the run ends.
        let pool = ThreadPoolBuilder::new().num_threads(1).build();
        let mut page = Page {
            directory: directory.to_owned(),
            pool: pool.map_err(|error| fault(&error))?,
            is_open: false,
        };
        let writer = Builder::new()
            .name("watch".into())
            .spawn(move || page.keep(&ended));
        Ok(Self {
            end: Some(end),
            writer: Some(writer.map_err(|error| fault(&error))?),
        })
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(writer) = self.writer.take() {
            // A panic of the writer was already reported; the run is complete anyway.
            let _ = writer.join();
        }
    }
}

/// The page of a run in progress.
struct Page {
    directory: PathBuf,
    pool: ThreadPool,
    is_open: bool,
}

impl Page {
    /// Writes the page repeatedly until the run has ended.
    fn keep(&mut self, ended: &Receiver<()>) {
        let mut wait = FIRST;
        while ended.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
            let start = Instant::now();
            match self.write(Some(PERIOD.as_secs_f64())) {
                Ok(_) => wait = PERIOD.max(PATIENCE * start.elapsed()),
                // A new run has no outputs yet, and a run that starts over removes the old ones.
                Err(error) => tracing::debug!("no page yet: {error}"),
            }
        }
        match self.write(None) {
            Ok(_) => {}
            // The run itself reports why it left no results.
            Err(ViewError::NotResults(_) | ViewError::NoNodes(_)) => {}
            Err(error) => tracing::warn!("the page of the run could not be written: {error}"),
        }
    }

    fn write(&mut self, reload: Option<f64>) -> Result<WrittenPage, ViewError> {
        let to = self.directory.join(PAGE);
        let write = || write_page_that_reloads(&self.directory, &to, OUTPUTS, reload, &|_, _| {});
        let written = self.pool.install(write)?;
        if !self.is_open {
            self.is_open = true;
            // Do not wait for the browser, which may run until its window is closed.
            let page = to.display();
            match open::that_detached(&to) {
                // The program that opens pages may be there without a browser.
                Ok(()) => tracing::warn!("the page of the run is {page}"),
                Err(error) => tracing::warn!("no browser could be started: {error}; open {page}"),
            }
        }
        Ok(written)
    }
}
