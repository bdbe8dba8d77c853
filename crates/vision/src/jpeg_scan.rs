//! Checks that the coded pixels of a JPEG file are all there, before they are decoded.
//!
//! A decoder fills missing blocks with grey, as browsers do, and reads shifted ones as other pixels, which would give wrong results
//! here. Therefore the codes of every scan are walked through: there must be exactly as many as the header's blocks need.
//!
//! Format: ITU-T T.81 (<https://www.w3.org/Graphics/JPEG/itu-t81.pdf>), sections F.2 and G.2.

use std::ops::Range;

use super::jpeg_code::{Bits, Codes};

/// Blocks of 8 × 8 coefficients.
const BLOCK: usize = 64;
/// Whole bytes that may be left behind the last block: some cameras fill up.
const MOST_FILL_BYTES: usize = 3;
/// The squares of the 64 coefficients of a block add up to those of its pixels around grey, with 8 bits at most 64 · 128².
const MOST_NORM: f64 = 1024.0;
/// So many bytes of 0 are no codes, unless 0 is the code of blocks that end.
const MOST_ZEROS: usize = 12;

/// What is wrong with the coded pixels of a JPEG file; `None` if they are all there, or of a kind that the decoder refuses.
pub(super) fn fault(bytes: &[u8]) -> Option<String> {
    Scans::default().walk(bytes).err()
}

/// One colour component.
struct Component {
    id: u8,
    /// Blocks across and down in one unit of an interleaved scan.
    across: usize,
    down: usize,
    table: usize,
    /// Blocks with pixels of the picture, across and down.
    columns: usize,
    rows: usize,
    /// Blocks across with those that only complete a unit.
    stride: usize,
    is_seen: bool,
    /// For each block, which coefficients are not 0: refining scans have one bit for each of them. Only in progressive files.
    set: Vec<u64>,
}

struct Frame {
    is_progressive: bool,
    precision: u8,
    /// Units of an interleaved scan, across and down.
    units: (usize, usize),
    components: Vec<Component>,
}

/// The tables and the frame that the segments read so far have stated.
#[derive(Default)]
struct Scans {
    frame: Option<Frame>,
    means: [Option<Codes>; 4],
    others: [Option<Codes>; 4],
    steps: [Steps; 4],
    restart: usize,
}

/// A table of the steps in which coefficients are counted.
#[derive(Default)]
struct Steps(Vec<f64>);

impl Steps {
    /// The largest norm of a block's coefficients, each of which is rounded to a whole step; infinite where nothing is stated.
    fn most(&self, precision: u8) -> f64 {
        let halves = self.0.iter().map(|step| 0.25 * step * step);
        match self.0.is_empty() {
            true => f64::INFINITY,
            false => {
                MOST_NORM * f64::from(1 << precision.saturating_sub(8).min(8))
                    + halves.sum::<f64>().sqrt()
            }
        }
    }

    fn of(&self, index: usize) -> f64 {
        self.0.get(index).copied().unwrap_or(0.0)
    }
}

/// What a scan holds: the coefficients `band`, from bit `low` on; `is_first` if no scan held upper bits of them.
struct Part {
    band: Range<usize>,
    low: u32,
    is_first: bool,
    is_progressive: bool,
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let pair = bytes.get(at..at + 2)?;
    Some(usize::from(pair[0]) << 8 | usize::from(pair[1]))
}

const SHORT: &str = "a segment that is cut off";

impl Scans {
    fn walk(&mut self, bytes: &[u8]) -> Result<(), String> {
        let mut at = 2;
        loop {
            let end = || "a JPEG file that is cut off: it has no end marker".to_owned();
            let skipped = bytes.get(at..).unwrap_or_default();
            at += skipped
                .iter()
                .position(|byte| *byte == 0xff)
                .ok_or_else(end)?;
            let marker = *bytes.get(at + 1).ok_or_else(end)?;
            at += match marker {
                // A fill byte.
                0xff => 1,
                0x00 | 0x01 | 0xd0..=0xd8 => 2,
                0xd9 => return self.must_be_complete(),
                _ => {
                    let length = word(bytes, at + 2).ok_or_else(end)?;
                    let body = bytes.get(at + 4..at + 2 + length).ok_or_else(end)?;
                    let after = &bytes[at + 2 + length..];
                    2 + length + self.segment(marker, body, after)?
                }
            };
        }
    }

    /// Reads a segment; returns the number of bytes of coded pixels behind it.
    fn segment(&mut self, marker: u8, body: &[u8], after: &[u8]) -> Result<usize, String> {
        let short = || SHORT.to_owned();
        match marker {
            0xc0..=0xc2 => {
                let frame = Frame::read(body, marker == 0xc2).ok_or_else(short)?;
                if self.frame.replace(frame).is_some() {
                    return Err("two headers of one picture".to_owned());
                }
            }
            0xc4 => self.codes(body).ok_or_else(short)?,
            0xdb => self.steps(body).ok_or_else(short)?,
            0xdd => self.restart = word(body, 0).ok_or_else(short)?,
            0xda => return self.scan(body, after),
            _ => {}
        }
        Ok(0)
    }

    fn codes(&mut self, mut body: &[u8]) -> Option<()> {
        while let Some((head, rest)) = body.split_first() {
            let (counts, rest) = rest.split_first_chunk::<16>()?;
            let size = counts.iter().map(|count| usize::from(*count)).sum();
            let tables = match head >> 4 {
                0 => &mut self.means,
                _ => &mut self.others,
            };
            *tables.get_mut(usize::from(head & 15))? = Some(Codes::new(counts, rest.get(..size)?));
            body = &rest[size..];
        }
        Some(())
    }

    fn steps(&mut self, mut body: &[u8]) -> Option<()> {
        while let Some((head, rest)) = body.split_first() {
            let is_wide = head >> 4 != 0;
            let size = 1 + usize::from(is_wide);
            let (own, rest) = rest.split_at_checked(BLOCK * size)?;
            let steps = (0..BLOCK).map(|index| match is_wide {
                true => word(own, 2 * index).map(|step| step as f64),
                false => Some(f64::from(own[index])),
            });
            *self.steps.get_mut(usize::from(head & 15))? = Steps(steps.collect::<Option<_>>()?);
            body = rest;
        }
        Some(())
    }

    fn must_be_complete(&self) -> Result<(), String> {
        match &self.frame {
            // Of another kind: the decoder says so.
            None => Ok(()),
            Some(frame) if frame.components.iter().all(|component| component.is_seen) => Ok(()),
            Some(_) => Err("no coded pixels for one of its colours".to_owned()),
        }
    }

    fn scan(&mut self, body: &[u8], after: &[u8]) -> Result<usize, String> {
        let short = || SHORT.to_owned();
        let Some(frame) = &mut self.frame else {
            return Ok(0);
        };
        let count = usize::from(*body.first().ok_or_else(short)?);
        let (named, rest) = body[1..].split_at_checked(2 * count).ok_or_else(short)?;
        let &[from, to, bits, ..] = rest else {
            return Err(short());
        };
        let mut parts = Vec::with_capacity(count);
        for pair in named.chunks_exact(2) {
            let mut known = frame.components.iter();
            let index = known.position(|component| component.id == pair[0]);
            let index = index.ok_or("a scan of a colour that the header does not state")?;
            parts.push((index, usize::from(pair[1] >> 4), usize::from(pair[1] & 15)));
        }
        let band = match frame.is_progressive {
            true => usize::from(from)..usize::from(to) + 1,
            false => 0..BLOCK,
        };
        let is_of_one_kind = band.start > 0 || band.end == 1 || !frame.is_progressive;
        if parts.is_empty() || band.end > BLOCK || band.is_empty() || !is_of_one_kind {
            return Err("a scan of coefficients that no block has".to_owned());
        }
        let walk = Walk {
            means: &self.means,
            others: &self.others,
            steps: &self.steps,
            restart: self.restart,
            part: Part {
                is_first: bits >> 4 == 0,
                low: u32::from(bits & 15),
                is_progressive: frame.is_progressive,
                band,
            },
            parts,
        };
        walk.run(frame, after)
    }
}

impl Frame {
    fn read(body: &[u8], is_progressive: bool) -> Option<Self> {
        let (height, width) = (word(body, 1)?, word(body, 3)?);
        let count = usize::from(*body.get(5)?);
        let described = body.get(6..6 + 3 * count)?;
        let sizes = described
            .chunks_exact(3)
            .map(|c| (usize::from(c[1] >> 4), usize::from(c[1] & 15)));
        let (most_across, most_down) = sizes.clone().fold((1, 1), |most, size| {
            (most.0.max(size.0), most.1.max(size.1))
        });
        let units = (
            width.div_ceil(8 * most_across),
            height.div_ceil(8 * most_down),
        );
        let described = described.chunks_exact(3).zip(sizes);
        let components = described.map(|(bytes, (across, down))| Component {
            id: bytes[0],
            across,
            down,
            table: usize::from(bytes[2] & 3),
            columns: (width * across).div_ceil(most_across).div_ceil(8),
            rows: (height * down).div_ceil(most_down).div_ceil(8),
            stride: units.0 * across,
            is_seen: false,
            set: match is_progressive {
                true => vec![0; units.0 * across * units.1 * down],
                false => Vec::new(),
            },
        });
        Some(Self {
            is_progressive,
            precision: body[0],
            units,
            components: components.collect(),
        })
    }
}

/// The walk through one scan.
struct Walk<'a> {
    means: &'a [Option<Codes>; 4],
    others: &'a [Option<Codes>; 4],
    steps: &'a [Steps; 4],
    restart: usize,
    part: Part,
    /// Index of a component, and of its two tables of codes.
    parts: Vec<(usize, usize, usize)>,
}

/// One block, and what the blocks before it in its scan have left.
struct Block<'a> {
    steps: &'a Steps,
    /// The largest norm of its coefficients.
    most: f64,
    /// The mean of the block before it.
    mean: &'a mut i64,
    /// The number of blocks that have no more coefficients.
    run: &'a mut u32,
    set: &'a mut u64,
}

/// Refuses more than `most` bytes behind the last block.
fn must_end(bits: &mut Bits<'_>, most: usize) -> Result<(), String> {
    match bits.bytes_left() {
        Some(left) if left <= most => Ok(()),
        Some(left) => Err(format!(
            "{left} bytes of coded pixels behind the last block"
        )),
        None => Err("other bits than those that fill the last byte".to_owned()),
    }
}

/// Why a block cannot be walked through.
enum Stop {
    End,
    Fault(&'static str),
}

const NO_CODE: Stop = Stop::Fault("a code that its table does not have");
const BEYOND: Stop = Stop::Fault("a block with more than 64 coefficients");
const NO_TABLE: Stop = Stop::Fault("codes without their table");

impl Walk<'_> {
    fn run(&self, frame: &mut Frame, after: &[u8]) -> Result<usize, String> {
        let is_alone = self.parts.len() == 1;
        let (units_across, units_down) = match self.parts.as_slice() {
            [(index, ..)] => {
                let only = &frame.components[*index];
                (only.columns, only.rows)
            }
            _ => frame.units,
        };
        let units = units_across * units_down;
        let mut bits = Bits::new(after);
        let most = frame.components.iter();
        let most: Vec<f64> = most
            .map(|component| self.steps[component.table].most(frame.precision))
            .collect();
        let mut means = [0_i64; 4];
        let mut run = 0;
        let mut restarts = 0;
        for unit in 0..units {
            if self.restart > 0 && unit > 0 && unit % self.restart == 0 {
                must_end(&mut bits, 0)?;
                if !bits.restarts((restarts % 8) as u8) {
                    return Err(format!(
                        "no restart marker where one must be, after {unit} of {units} blocks"
                    ));
                }
                restarts += 1;
                (means, run) = ([0; 4], 0);
            }
            let (x, y) = (unit % units_across, unit / units_across);
            for (place, part) in self.parts.iter().enumerate() {
                let component = &mut frame.components[part.0];
                component.is_seen |= self.part.band.start == 0;
                let (across, down) = match is_alone {
                    true => (1, 1),
                    false => (component.across, component.down),
                };
                for block in 0..across * down {
                    let column = x * across + block % across;
                    let row = y * down + block / across;
                    let index = row * component.stride + column;
                    let mut none = 0;
                    let mut at = Block {
                        steps: &self.steps[component.table],
                        most: most[part.0],
                        mean: &mut means[place & 3],
                        run: &mut run,
                        set: component.set.get_mut(index).unwrap_or(&mut none),
                    };
                    let done = self.block(&mut bits, part, &mut at);
                    done.map_err(|stop| match stop {
                        Stop::End => {
                            format!("coded pixels that end after {unit} of {units} blocks")
                        }
                        Stop::Fault(what) => format!("{what}, after {unit} of {units} blocks"),
                    })?;
                }
            }
        }
        must_end(&mut bits, MOST_FILL_BYTES)?;
        let end = bits.place();
        self.must_have_no_hole(&after[..end])?;
        Ok(end)
    }

    /// Refuses a part of the file that was lost and filled with zeros.
    fn must_have_no_hole(&self, codes: &[u8]) -> Result<(), String> {
        let is_of_ends = |(_, _, table): &(usize, usize, usize)| {
            let table = self.others.get(*table).and_then(Option::as_ref);
            table.is_none_or(|codes| codes.first().is_none_or(|symbol| symbol & 15 == 0))
        };
        if !self.part.is_first || self.part.band.end == 1 || self.parts.iter().all(is_of_ends) {
            return Ok(());
        }
        let mut zeros = codes.windows(MOST_ZEROS);
        match zeros.position(|all| all.iter().all(|byte| *byte == 0)) {
            None => Ok(()),
            Some(place) => Err(format!(
                "zeros in place of coded pixels, {} % behind their start",
                100 * place / codes.len()
            )),
        }
    }

    fn block(
        &self,
        bits: &mut Bits<'_>,
        (_, mean_table, other_table): &(usize, usize, usize),
        block: &mut Block<'_>,
    ) -> Result<(), Stop> {
        let part = &self.part;
        let table = |all: &'_ [Option<Codes>; 4], index: usize| -> Result<usize, Stop> {
            let is_there = all.get(index).is_some_and(Option::is_some);
            is_there.then_some(index).ok_or(NO_TABLE)
        };
        let mut from = part.band.start;
        let mut square = 0.0;
        if from == 0 {
            match part.is_first {
                true => {
                    let index = table(self.means, *mean_table)?;
                    let codes = self.means[index].as_ref().ok_or(NO_TABLE)?;
                    let size = u32::from(bits.code(codes)?);
                    if size > 15 {
                        return Err(NO_CODE);
                    }
                    *block.mean += bits.number(size)?;
                    square = (((*block.mean) << part.low) as f64 * block.steps.of(0)).powi(2);
                }
                false => drop(bits.take(1)?),
            }
            from = 1;
        }
        if part.band.end > from {
            let index = table(self.others, *other_table)?;
            let codes = self.others[index].as_ref().ok_or(NO_TABLE)?;
            match part.is_first || !part.is_progressive {
                true => square += self.first(bits, codes, from, block)?,
                false => self.refined(bits, codes, from, block)?,
            }
        }
        match square.sqrt() > block.most {
            true => Err(Stop::Fault(
                "a block that is brighter or darker than any pixel",
            )),
            false => Ok(()),
        }
    }

    /// Coefficients with their first bits; the sum of their squares.
    fn first(
        &self,
        bits: &mut Bits<'_>,
        codes: &Codes,
        from: usize,
        block: &mut Block<'_>,
    ) -> Result<f64, Stop> {
        let run = &mut *block.run;
        if *run > 0 {
            *run -= 1;
            return Ok(0.0);
        }
        let end = self.part.band.end;
        let mut square = 0.0;
        let mut at = from;
        while at < end {
            let code = bits.code(codes)?;
            let (zeros, size) = (u32::from(code >> 4), u32::from(code & 15));
            if size == 0 && zeros < 15 {
                if zeros > 0 && !self.part.is_progressive {
                    return Err(NO_CODE);
                }
                // The end of this block, and of so many behind it.
                *run = (1 << zeros) - 1 + bits.take(zeros)?;
                return Ok(square);
            }
            at += zeros as usize;
            if at >= end {
                return Err(BEYOND);
            }
            if size > 0 {
                let value = bits.number(size)? << self.part.low;
                square += (value as f64 * block.steps.of(at)).powi(2);
                *block.set |= 1 << at;
            }
            at += 1;
        }
        Ok(square)
    }

    /// One more bit of coefficients that are known, and the first of others.
    fn refined(
        &self,
        bits: &mut Bits<'_>,
        codes: &Codes,
        from: usize,
        block: &mut Block<'_>,
    ) -> Result<(), Stop> {
        let end = self.part.band.end;
        let (run, set) = (&mut *block.run, &mut *block.set);
        let mut at = from;
        if *run == 0 {
            while at < end {
                let code = bits.code(codes)?;
                let (mut zeros, size) = (u32::from(code >> 4), code & 15);
                if size == 0 && zeros < 15 {
                    *run = (1 << zeros) + bits.take(zeros)?;
                    break;
                }
                if size > 1 {
                    return Err(NO_CODE);
                }
                bits.take(u32::from(size))?;
                while at < end {
                    if *set >> at & 1 == 1 {
                        bits.take(1)?;
                    } else if zeros == 0 {
                        break;
                    } else {
                        zeros -= 1;
                    }
                    at += 1;
                }
                if size == 1 {
                    if at >= end {
                        return Err(BEYOND);
                    }
                    *set |= 1 << at;
                }
                at += 1;
            }
        }
        if *run > 0 {
            for place in at..end {
                bits.take((*set >> place & 1) as u32)?;
            }
            *run -= 1;
        }
        Ok(())
    }
}

impl From<super::jpeg_code::Missing> for Stop {
    fn from(missing: super::jpeg_code::Missing) -> Self {
        match missing {
            super::jpeg_code::Missing::Bits => Self::End,
            super::jpeg_code::Missing::Code => NO_CODE,
        }
    }
}

#[cfg(test)]
mod tests {
    use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
    use rand_distr::{Distribution as _, Uniform};
    use realgap_core::random::Once;

    use super::fault;
    use crate::Picture;

    /// Seed of the pictures and of the places of damage.
    const SEED: u64 = 57;
    const WIDTH: u16 = 131;
    const HEIGHT: u16 = 97;

    /// A picture with edges and noise, in every kind of file: progressive, with restart markers, with tables of its own, grey.
    fn files() -> Vec<(String, Vec<u8>)> {
        let mut rng = Once::Subset.generator(SEED);
        let noise = Uniform::new_inclusive(0, 40).unwrap();
        let pixel = |i: usize| (i % usize::from(WIDTH) / 9 * 13 + i / 1800 * 29) % 200;
        let count = usize::from(WIDTH) * usize::from(HEIGHT);
        let grey: Vec<u8> = (0..count)
            .map(|i| pixel(i) as u8 + noise.sample(&mut rng))
            .collect();
        let rgb: Vec<u8> = (0..3 * count)
            .map(|i| pixel(i / 3 + 7 * (i % 3)) as u8 + noise.sample(&mut rng))
            .collect();
        let mut all = Vec::new();
        for (color, pixels) in [(ColorType::Rgb, &rgb), (ColorType::Luma, &grey)] {
            for sampling in [
                SamplingFactor::F_1_1,
                SamplingFactor::F_2_1,
                SamplingFactor::F_2_2,
            ] {
                for (is_progressive, restart, is_optimized) in [
                    (false, 0, false),
                    (false, 3, false),
                    (false, 0, true),
                    (true, 0, false),
                    (true, 7, false),
                ] {
                    let mut bytes = Vec::new();
                    let mut encoder = Encoder::new(&mut bytes, 85);
                    encoder.set_sampling_factor(sampling);
                    encoder.set_progressive(is_progressive);
                    encoder.set_restart_interval(restart);
                    encoder.set_optimized_huffman_tables(is_optimized);
                    encoder.encode(pixels, WIDTH, HEIGHT, color).unwrap();
                    let name = format!("{color:?} {sampling:?} {is_progressive} {restart}");
                    all.push((name, bytes));
                }
            }
        }
        all
    }

    fn is_read(bytes: &[u8]) -> bool {
        Picture::decode(bytes).is_ok()
    }

    #[test]
    fn a_jpeg_with_a_hole_zeros_or_a_larger_size_is_refused_in_every_kind_of_file() {
        let mut rng = Once::Subset.generator(SEED);
        let (mut tries, mut silent) = (0, 0);
        for (name, whole) in files() {
            assert_eq!(fault(&whole), None, "{name}");
            assert!(is_read(&whole), "{name}");
            let scan = whole
                .windows(2)
                .position(|pair| pair == [0xff, 0xda])
                .unwrap()
                + 20;
            let place = Uniform::new(scan, whole.len() - 300).unwrap();
            let length = Uniform::new(30, 200).unwrap();
            for _ in 0..15 {
                let from = place.sample(&mut rng);
                let to = from + length.sample(&mut rng);
                let hole = [&whole[..from], &whole[to..]].concat();
                let zeros = [&whole[..from], &vec![0; to - from], &whole[to..]].concat();
                for damaged in [hole, zeros] {
                    tries += 1;
                    silent += usize::from(is_read(&damaged));
                }
            }
            let head = whole
                .windows(2)
                .position(|pair| matches!(pair, [0xff, 0xc0 | 0xc2]))
                .unwrap();
            let mut larger = whole.clone();
            larger[head + 5..head + 9].copy_from_slice(&[0x15, 0xe0, 0x15, 0xe0]);
            let found = fault(&larger).unwrap_or_default();
            assert!(
                found.contains("after") && found.contains("blocks"),
                "{name}: {found}"
            );
        }
        // A hole may happen to lose as many blocks as the codes behind it seem to make: nothing in the file tells.
        assert!(100 * silent <= tries, "{silent} of {tries}");
    }
}
