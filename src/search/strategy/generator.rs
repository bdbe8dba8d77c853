//! Random numbers of a search: every step has a generator of its own.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The generator of step number `step` of the search with this seed. Steps are independent, so that any one can be
/// replayed without those before it.
pub fn generator(seed: u64, step: u64) -> ChaCha8Rng {
    let mut key = [0_u8; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&step.to_le_bytes());
    // Uncertain parameters have the same key and stream 101. Servo gains share this one, which couples nothing: they do not choose genomes.
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(3);
    rng
}
