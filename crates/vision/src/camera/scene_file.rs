//! Reads scenes from RON files.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::camera_file::CameraFile;
use super::lens::Pose;
use super::poster::{Motif, Texture};
use super::reader::Reader;
use super::scene::Faces;
use super::scene::{Block, Camera, Lamp, Light, Mount, Poster, Scene, View};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, check_name, look_up, orientation, parse_ron};

/// A position, a direction or a colour.
type Three = [f64; 3];

/// A room to take pictures of, as its file states it.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Scene")]
pub struct SceneFile {
    /// Name of the scene.
    name: String,
    /// Size of the room, which begins at the corner (0, 0, 0), metres.
    room_m: Three,
    /// Reflectance of the walls for red, green and blue, 0 to 1.
    #[serde(default = "light_grey")]
    wall: Three,
    /// Reflectance of the floor for red, green and blue, 0 to 1.
    #[serde(default = "light_grey")]
    floor: Three,
    /// Reflectance of the ceiling for red, green and blue, 0 to 1.
    #[serde(default = "light_grey")]
    ceiling: Three,
    /// Side of the floor's tiles, of which every second is darker, metres; 0 for a floor without tiles.
    #[serde(default)]
    tile_m: f64,
    /// Boxes and cubes.
    #[serde(default)]
    blocks: Vec<BlockFile>,
    /// Posters.
    #[serde(default)]
    posters: Vec<PosterFile>,
    /// Lights, by name.
    lights: BTreeMap<String, LightFile>,
    /// Cameras, by name.
    cameras: BTreeMap<String, CameraFile>,
    /// Viewpoints from which pictures are taken.
    views: Vec<ViewFile>,
    /// Mounts of cameras on bodies (`realgap sense picture --ride`), with the start of the motion, by name.
    #[serde(default)]
    mounts: BTreeMap<String, MountFile>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Block")]
struct BlockFile {
    /// Centre, metres.
    centre_m: Three,
    /// Half of its sides, metres.
    half_m: Three,
    /// Orientation in the room, a quaternion, real part first.
    #[serde(default = "upright")]
    orientation_wxyz: (f64, f64, f64, f64),
    /// Rotation about the vertical after that orientation, counter-clockwise, degrees.
    #[serde(default)]
    turn_deg: f64,
    /// Reflectance for red, green and blue, 0 to 1.
    #[serde(default = "light_grey")]
    colour: Three,
    /// Pattern of the faces.
    #[serde(default)]
    faces: Faces,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Poster")]
struct PosterFile {
    /// Centre, metres.
    centre_m: Three,
    /// Width, metres.
    width_m: f64,
    /// Direction that the poster faces, degrees counter-clockwise from the x axis.
    facing_deg: f64,
    /// Motif of the poster.
    motif: Motif,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Light")]
struct LightFile {
    /// Ambient illuminance, lux.
    ambient_lux: f64,
    /// Lamps.
    #[serde(default)]
    lamps: Vec<Lamp>,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "View")]
struct ViewFile {
    /// Name of the view, which is also the name of its pictures.
    name: String,
    /// Position of the camera, metres.
    place_m: Three,
    /// Point at which the camera looks, metres.
    look_at_m: Three,
}

#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Mount")]
struct MountFile {
    /// Name of the body: a part in the file of `realgap simulate --parts`; by default the tracked body.
    #[serde(default)]
    body: Option<String>,
    /// Position of the camera on the body, in the body's frame, metres.
    #[serde(default)]
    place_m: Three,
    /// Direction in which the camera looks, in the body's frame.
    #[serde(default = "forwards")]
    ahead: Three,
    /// Position in the room at which the motion begins, metres.
    start_m: [f64; 2],
    /// Direction of the motion's x axis in the room, degrees counter-clockwise from the room's x axis.
    #[serde(default)]
    facing_deg: f64,
}

fn forwards() -> Three {
    [1.0, 0.0, 0.0]
}

fn upright() -> (f64, f64, f64, f64) {
    (1.0, 0.0, 0.0, 0.0)
}

fn light_grey() -> Three {
    [0.7; 3]
}

/// Largest side of a room, metres, and largest number of blocks and posters in it.
const LARGEST_M: f64 = 1000.0;
const MOST: usize = 10_000;

impl Reader<'_> {
    fn colour(&self, field: &str, colour: Three) -> Result<Three> {
        if colour.iter().all(|share| (0.0..=1.0).contains(share)) {
            return Ok(colour);
        }
        Err(self.wrong(
            field,
            "not a colour",
            format!("{colour:?}"),
            "three shares, 0 to 1",
        ))
    }

    fn inside(&self, field: &str, place: Three, room_m: Three) -> Result<Three> {
        if (0..3).all(|i| place[i] > 0.0 && place[i] < room_m[i]) {
            return Ok(place);
        }
        Err(self.wrong(
            field,
            "not inside of the room",
            format!("{place:?} m"),
            &format!("between (0, 0, 0) and {room_m:?} m"),
        ))
    }

    fn block(&self, field: &str, file: &BlockFile) -> Result<Block> {
        let (centre_m, half_m) = (file.centre_m, file.half_m);
        let is_sound = half_m.iter().all(|h| *h > 0.0 && *h <= LARGEST_M)
            && centre_m.iter().all(|c| c.is_finite())
            && file.turn_deg.is_finite();
        if !is_sound {
            let found = format!("half {half_m:?} m at {centre_m:?} m");
            return Err(self.wrong(
                field,
                "not a box",
                found,
                "halves above 0 m at a finite place",
            ));
        }
        let turn = orientation(file.orientation_wxyz).map_err(|error| {
            let field = format!("{field}.orientation_wxyz");
            self.0.at(&field, error.field(&field))
        })?;
        let turn = turn.to_rotation_matrix();
        let (sin, cos) = file.turn_deg.to_radians().sin_cos();
        Ok(Block {
            centre_m,
            half_m,
            axes: [0, 1, 2].map(|axis| {
                let [x, y, z] = [0, 1, 2].map(|row| turn[(row, axis)]);
                [cos * x - sin * y, sin * x + cos * y, z]
            }),
            colour: self.colour(&format!("{field}.colour"), file.colour)?,
            faces: file.faces,
            planes: [].into(),
            is_seen: true,
        })
    }

    fn poster(&self, field: &str, file: PosterFile, room_m: [f64; 3]) -> Result<Poster> {
        let width_m = self.within(&format!("{field}.width_m"), file.width_m, 0.01, 100.0, "m")?;
        let facing = self.within(
            &format!("{field}.facing_deg"),
            file.facing_deg,
            -360.0,
            360.0,
            "degrees",
        )?;
        let at = |e: Error| self.0.at(field, e);
        let texture = Texture::new(&file.motif).map_err(at)?;
        let height_m = width_m / texture.shape();
        let (sin, cos) = facing.to_radians().sin_cos();
        Ok(Poster {
            centre_m: self.inside(&format!("{field}.centre_m"), file.centre_m, room_m)?,
            // For an observer, right is to the left of the direction that the poster faces.
            right_m: [-0.5 * width_m * sin, 0.5 * width_m * cos, 0.0],
            down_m: [0.0, 0.0, -0.5 * height_m],
            motif: file.motif,
            texture,
        })
    }

    fn view(&self, field: &str, file: ViewFile, scene: &Scene) -> Result<View> {
        check_name(&file.name, "a view").map_err(|e| self.0.at(field, e.field(field)))?;
        let place = self.inside(field, file.place_m, scene.room_m)?;
        if scene.blocks.iter().any(|block| block.holds(place)) {
            let found = format!("{place:?} m");
            return Err(self.wrong(field, "the camera stands in a box", found, "a free place"));
        }
        let Some(pose) = Pose::towards(place, file.look_at_m) else {
            return Err(self.wrong(
                field,
                "the direction of the camera is not valid",
                format!("{:?} m", file.look_at_m),
                "a point that is not straight above or below the camera",
            ));
        };
        if scene.views.iter().any(|v| v.name == file.name) {
            return Err(self.wrong(
                field,
                "a view is listed twice",
                file.name,
                "different names",
            ));
        }
        Ok(View {
            name: file.name,
            pose,
        })
    }

    fn mount(&self, name: String, file: MountFile) -> Result<Mount> {
        let at = |field: &str| format!("mounts.{name}.{field}");
        let (ahead, place) = (file.ahead, file.place_m);
        let level = ahead[0].hypot(ahead[1]);
        let length = level.hypot(ahead[2]);
        if !(length.is_finite() && level > 1e-3 * length) {
            return Err(self.wrong(
                &at("ahead"),
                "the direction of the camera is not valid",
                format!("{ahead:?}"),
                "a direction that is not straight up or down",
            ));
        }
        for (field, places) in [("place_m", &place[..]), ("start_m", &file.start_m)] {
            for value in places {
                self.within(&at(field), *value, -LARGEST_M, LARGEST_M, "m")?;
            }
        }
        let facing = self.within(&at("facing_deg"), file.facing_deg, -360.0, 360.0, "degrees")?;
        Ok(Mount {
            body: file.body,
            place_body_m: place,
            ahead_body: ahead.map(|v| v / length),
            start_m: file.start_m,
            facing_rad: facing.to_radians(),
            name,
        })
    }
}

impl Scene {
    /// Reads a scene.
    ///
    /// # Errors
    /// A missing file, anything that is not a scene, values out of range, lamps or viewpoints outside of the room or in a box.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "scene")?)
    }

    /// Parses a scene from a text.
    ///
    /// # Errors
    /// The errors of [`Scene::read`].
    pub fn parse(source: &Source) -> Result<Self> {
        let file: SceneFile = parse_ron(source)?;
        let reader = Reader(source);
        let room_m = file.room_m;
        for side in room_m {
            reader.within("room_m", side, 0.1, LARGEST_M, "m")?;
        }
        reader.within("tile_m", file.tile_m, 0.0, LARGEST_M, "m")?;
        let things = file.blocks.len() + file.posters.len();
        if things > MOST {
            return Err(reader.wrong("blocks", "too many things", things, "at most 10000"));
        }
        let mut scene = Self {
            name: file.name,
            room_m,
            wall: reader.colour("wall", file.wall)?,
            floor: reader.colour("floor", file.floor)?,
            ceiling: reader.colour("ceiling", file.ceiling)?,
            tile_m: file.tile_m,
            blocks: Vec::new(),
            posters: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
            views: Vec::new(),
            mounts: Vec::new(),
        };
        for (index, block) in file.blocks.iter().enumerate() {
            scene
                .blocks
                .push(reader.block(&format!("blocks[{index}]"), block)?);
        }
        for (index, poster) in file.posters.into_iter().enumerate() {
            let poster = reader.poster(&format!("posters[{index}]"), poster, room_m)?;
            scene.posters.push(poster);
        }
        for (name, light) in file.lights {
            let at = |field: &str| format!("lights.{name}.{field}");
            for (index, lamp) in light.lamps.iter().enumerate() {
                let field = at(&format!("lamps[{index}]"));
                reader.inside(&field, lamp.place_m, room_m)?;
                reader.within(&field, lamp.intensity_cd, 0.0, 1e7, "cd")?;
            }
            scene.lights.push(Light {
                ambient_lux: reader.within(
                    &at("ambient_lux"),
                    light.ambient_lux,
                    0.0,
                    1e6,
                    "lux",
                )?,
                lamps: light.lamps,
                name,
            });
        }
        for (name, camera) in file.cameras {
            let at = format!("cameras.{name}.");
            scene.cameras.push(camera.camera(&reader, &at, name)?);
        }
        for (index, view) in file.views.into_iter().enumerate() {
            let view = reader.view(&format!("views[{index}]"), view, &scene)?;
            scene.views.push(view);
        }
        for (name, mount) in file.mounts {
            scene.mounts.push(reader.mount(name, mount)?);
        }
        for (field, is_empty) in [
            ("lights", scene.lights.is_empty()),
            ("cameras", scene.cameras.is_empty()),
            ("views", scene.views.is_empty()),
        ] {
            if is_empty {
                return Err(reader.wrong(field, "a scene needs one", 0, "one or more"));
            }
        }
        Ok(scene)
    }

    /// The camera of this name.
    ///
    /// # Errors
    /// An unknown name; the error lists the known ones.
    pub fn camera(&self, name: &str) -> Result<&Camera> {
        look_up("camera", name, &self.cameras, |camera| camera.name.as_str())
    }

    /// The mount of this name.
    ///
    /// # Errors
    /// An unknown name; the error lists the known ones.
    pub fn mount(&self, name: &str) -> Result<&Mount> {
        look_up("mount", name, &self.mounts, |mount| mount.name.as_str())
    }

    /// The light of this name.
    ///
    /// # Errors
    /// An unknown name; the error lists the known ones.
    pub fn light(&self, name: &str) -> Result<&Light> {
        look_up("light", name, &self.lights, |light| light.name.as_str())
    }
}
