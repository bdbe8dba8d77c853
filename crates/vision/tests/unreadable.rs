//! Tests of files that are not pictures, of unusual pictures, and of impossible requests.

use realgap_vision::{Extractor, Grey, Picture, Region, Script, Sought, Template, correlation_map};

use crate::drawing::{grey, texture};

/// A PNG file with any header.
fn png(
    width: u32,
    height: u32,
    color: png::ColorType,
    depth: png::BitDepth,
    data: &[u8],
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

fn refused(bytes: &[u8]) -> String {
    Picture::decode(bytes).unwrap_err().to_string()
}

#[test]
fn a_file_that_is_not_a_picture_gives_an_error() {
    assert!(refused(b"").contains("an empty file"));
    let text = refused(b"t_s,x_m,y_m\n0,0,0\n");
    assert!(
        text.contains("not a picture") && text.contains("PNG and JPEG"),
        "{text}"
    );
    let broken = refused(&texture(9, 9).picture().to_png().unwrap()[..60]);
    assert!(broken.contains("cannot be decoded"), "{broken}");
    let cut = refused(&texture(9, 9).picture().to_jpeg(90).unwrap()[..30]);
    assert!(cut.contains("cannot be decoded"), "{cut}");
    let missing = Picture::read("no/such.png").unwrap_err().to_string();
    assert!(missing.contains("no/such.png"), "{missing}");
    let folder = Picture::read("src").unwrap_err().to_string();
    assert!(folder.contains("this is a folder"), "{folder}");
}

/// A header that states 100 megapixels is refused before memory for the picture is allocated.
#[test]
fn a_hundred_megapixels_are_refused_before_memory_is_allocated() {
    let mut bytes = texture(8, 8).picture().to_png().unwrap();
    bytes[16..20].copy_from_slice(&10_000_u32.to_be_bytes());
    bytes[20..24].copy_from_slice(&10_000_u32.to_be_bytes());
    // The checksum of the header, which follows its 17 bytes.
    let mut crc = 0xffff_ffff_u32;
    for byte in &bytes[12..29] {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0xedb8_8320
            } else {
                crc >> 1
            };
        }
    }
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    let error = refused(&bytes);
    assert!(error.contains("10000 x 10000"), "{error}");
}

/// A file of others: the second half of its codes is missing before the end marker, and browsers show a grey half.
#[test]
fn half_a_jpeg_with_an_end_marker_is_refused() {
    let path = "../../../shared/cases/faults/half.jpg";
    if !std::path::Path::new(path).is_file() {
        println!("SKIPPED: {path} is not here");
        return;
    }
    let error = Picture::read(path).unwrap_err().to_string();
    assert!(
        error.contains("half.jpg") && error.contains("coded pixels"),
        "{error}"
    );
}

#[test]
fn sixteen_bits_grey_and_transparent_pictures_are_read() {
    use png::{BitDepth, ColorType};
    let deep = png(
        2,
        1,
        ColorType::Grayscale,
        BitDepth::Sixteen,
        &[0x80, 0x12, 0xff, 0xff],
    );
    assert_eq!(
        Picture::decode(&deep).unwrap().rgb(),
        [0x80, 0x80, 0x80, 255, 255, 255]
    );
    let clear = png(
        2,
        1,
        ColorType::Rgba,
        BitDepth::Eight,
        &[10, 20, 30, 255, 10, 20, 30, 0],
    );
    assert_eq!(
        Picture::decode(&clear).unwrap().rgb(),
        [10, 20, 30, 255, 255, 255]
    );
    let one = png(1, 1, ColorType::Grayscale, BitDepth::One, &[0x80]);
    assert_eq!(Picture::decode(&one).unwrap().rgb(), [255; 3]);
}

#[test]
fn jpeg_keeps_a_picture_up_to_its_quality() {
    let smooth = grey(64, 48, |x, y| 0.2 + 0.006 * x as f32 + 0.004 * y as f32).picture();
    let off = |quality: u8| {
        let bytes = smooth.to_jpeg(quality).unwrap();
        let back = Picture::decode(&bytes).unwrap();
        assert_eq!((back.width(), back.height()), (64, 48));
        let sum: f64 = back
            .rgb()
            .iter()
            .zip(smooth.rgb())
            .map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs())
            .sum();
        sum / smooth.rgb().len() as f64
    };
    let (fine, coarse) = (off(95), off(5));
    assert!(fine < 1.0 && coarse > fine, "{fine} {coarse}");
}

#[test]
fn a_picture_of_one_pixel_goes_through_every_filter() {
    let one = grey(1, 1, |_, _| 0.4);
    let bytes = one.picture().to_png().unwrap();
    let back = Picture::decode(&bytes).unwrap().grey();
    assert!((back.at(0, 0) - 0.4).abs() < 0.003);
    assert_eq!(one.resized(3, 2).values(), [0.4; 6]);
    let (width, height, map) = correlation_map(&one, &one).unwrap();
    assert_eq!((width, height, map), (1, 1, vec![0.0]));
}

#[test]
fn templates_that_are_larger_than_the_picture_or_uniform_are_refused() {
    let small = texture(20, 20);
    let error = correlation_map(&small, &texture(21, 5))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("larger than the picture") && error.contains("20 x 20"),
        "{error}"
    );
    let error = Template::PAPER
        .find(&small, &texture(200, 200))
        .unwrap_err();
    assert!(
        error.to_string().contains("larger than the picture"),
        "{error}"
    );
    let blank = Template::PAPER
        .find(&small, &grey(5, 5, |_, _| 0.5))
        .unwrap_err();
    assert!(blank.to_string().contains("the same everywhere"), "{blank}");
}

#[test]
fn a_region_of_text_outside_of_the_picture_is_refused() {
    let region = Region {
        x_px: 10,
        y_px: 0,
        width_px: usize::MAX,
        height_px: 5,
    };
    let sought = Sought {
        text_region: Some(region),
        alphabet: Some(std::sync::Arc::new(
            realgap_vision::Alphabet::learn(
                &realgap_vision::print_text("A", 40.0, 0.0).unwrap(),
                "A",
            )
            .unwrap(),
        )),
        ..Sought::default()
    };
    let error = Script::PAPER
        .extract(&texture(20, 20), &sought)
        .unwrap_err();
    assert!(
        error.to_string().contains("not inside of the picture"),
        "{error}"
    );
    assert!(Grey::new(2, 2, vec![0.0, 0.0, f32::NAN, 0.0]).is_err());
    assert!(Grey::new(2, 2, vec![0.0]).is_err());
    assert!(Picture::new(0, 3, Vec::new()).is_err());
}
