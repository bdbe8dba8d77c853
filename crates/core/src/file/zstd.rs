//! Unpacks zstd.

use std::io::Read as _;

/// The largest window: what packs harder than usual asks for up to 128 MiB.
const MOST_WINDOW: u64 = 1 << 27;

/// The content of one frame of zstd, at most so many bytes; `None` if it is damaged, larger, shorter or longer than it says, or if
/// anything follows.
pub fn read_zstd(packed: &[u8], most: u64) -> Option<Vec<u8>> {
    let decoder = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(packed, MOST_WINDOW);
    let mut decoder = decoder.ok()?;
    let mut all = Vec::new();
    let mut limited = (&mut decoder).take(most.saturating_add(1));
    let length = limited.read_to_end(&mut all).ok()? as u64;
    // Writers state the size, but need not.
    let stated = decoder.decoder.content_size();
    let is_whole = (stated == 0 || stated == length) && decoder.get_ref().is_empty();
    (length <= most && is_whole).then_some(all)
}
