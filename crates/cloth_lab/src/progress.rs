//! Progress bars.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `steps` steps on standard error, shown where that is a terminal. Say what is being done with
/// [`ProgressBar::set_message`], step with [`ProgressBar::inc`], end with [`ProgressBar::finish_and_clear`].
pub fn bar(steps: u64) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} (left: {eta})  {msg}") {
        bar.set_style(style);
    }
    bar
}
