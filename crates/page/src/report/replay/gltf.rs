//! A replay as a glTF model that moves (`.glb`): for viewers, Blender, slides and web pages.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde_json::{Value, json};

use crate::report::replay::page::Replay;
use crate::report::replay::solid::{Kind, Solid};
use crate::report::replay::stage::{Actor, Stage, continuous};
use realgap_core::error::Result;
use realgap_robot::morphology::{Shape, Surface};

/// Most samples of one run in a file.
const MOST_SAMPLES: usize = 20_000;
/// Half the edge of the cube that stands for a run of which only a path is known, metres.
const POINT_HALF_M: f64 = 0.012;

/// glTF's numbers for what they name.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const LINE_STRIP: u32 = 3;

impl Replay<'_> {
    /// The replay as a binary glTF 2.0 file: one node for each part of each run, moved by one animation; recorded robots translucent
    /// and green, paths as lines. y is up, as in all glTF files; lengths are metres, numbers have single precision. Times count from
    /// the start of each run. Of a run of more than 20 000 samples every second, third, … is in the file.
    ///
    /// # Errors
    /// Paths too long to be compared.
    pub fn gltf(&self) -> Result<Vec<u8>> {
        let stage = self.stage(MOST_SAMPLES)?;
        let mut model = Model::default();
        let mut children = Vec::new();
        for solid in &stage.fixed {
            children.extend(model.solid(solid, 1.0));
        }
        for actor in &stage.actors {
            children.extend(model.actor(actor));
        }
        // From z up to y up.
        let up = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
        let root = model
            .node(json!({ "name": "world", "rotation": quaternion(&up), "children": children }));
        Ok(model.finish(root, &stage))
    }
}

/// A file that grows.
#[derive(Default)]
struct Model {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    /// What each material looks like.
    looks: Vec<(Kind, u64)>,
    /// Shapes whose triangles are in the file; all boxes are one.
    shapes: Vec<(Shape, Triangles)>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
}

/// The corners of a surface, face by face, their normals, and its triangles.
#[derive(Clone, Copy)]
struct Triangles {
    positions: usize,
    normals: usize,
    triangles: usize,
}

impl Model {
    fn node(&mut self, node: Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds numbers; `kind` is glTF's name for so many of them.
    fn accessor(&mut self, rows: &[Vec<f32>], kind: &str) -> usize {
        let offset = self.bytes.len();
        for value in rows.iter().flatten() {
            self.bytes.extend(value.to_le_bytes());
        }
        let width = rows.first().map_or(0, Vec::len);
        let of = |column: usize, fold: fn(f32, f32) -> f32, start: f32| {
            rows.iter().map(|row| row[column]).fold(start, fold)
        };
        let low: Vec<f32> = (0..width).map(|c| of(c, f32::min, f32::MAX)).collect();
        let high: Vec<f32> = (0..width).map(|c| of(c, f32::max, f32::MIN)).collect();
        let content = json!({ "componentType": FLOAT, "type": kind, "count": rows.len(), "min": low, "max": high });
        self.view(offset, content)
    }

    /// Bytes from `offset` to the end as a view, read as `content` says.
    fn view(&mut self, offset: usize, mut content: Value) -> usize {
        let length = self.bytes.len() - offset;
        self.views
            .push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
        content["bufferView"] = json!(self.views.len() - 1);
        self.accessors.push(content);
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        self.accessors.len() - 1
    }

    fn cube(&mut self) -> Triangles {
        let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for axis in 0..3 {
            for sign in [1.0_f32, -1.0] {
                let first = positions.len();
                for [u, v] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                    let mut corner = vec![0.0; 3];
                    corner[axis] = sign;
                    // Anticlockwise as seen from outside.
                    corner[(axis + 1) % 3] = u * sign;
                    corner[(axis + 2) % 3] = v;
                    positions.push(corner);
                    let mut normal = vec![0.0; 3];
                    normal[axis] = sign;
                    normals.push(normal);
                }
                triangles.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
            }
        }
        self.mesh(&positions, &normals, &triangles)
    }

    fn mesh(
        &mut self,
        positions: &[Vec<f32>],
        normals: &[Vec<f32>],
        triangles: &[usize],
    ) -> Triangles {
        let positions = self.accessor(positions, "VEC3");
        let normals = self.accessor(normals, "VEC3");
        let offset = self.bytes.len();
        for index in triangles {
            self.bytes.extend((*index as u16).to_le_bytes());
        }
        let content =
            json!({ "componentType": UNSIGNED_SHORT, "type": "SCALAR", "count": triangles.len() });
        Triangles {
            positions,
            normals,
            triangles: self.view(offset, content),
        }
    }

    /// The material of this kind.
    fn material(&mut self, kind: Kind, alpha: f64) -> usize {
        let look = (kind, alpha.to_bits());
        if let Some(known) = self.looks.iter().position(|known| *known == look) {
            return known;
        }
        let [r, g, b] = kind.light();
        let mut material = json!({
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, alpha], "metallicFactor": 0.0, "roughnessFactor": 0.9 },
        });
        if alpha < 1.0 {
            material["alphaMode"] = json!("BLEND");
        }
        self.looks.push(look);
        self.materials.push(material);
        self.looks.len() - 1
    }

    /// The triangles of a shape, once for all that have it; of all boxes those of a cube of half edge 1.
    fn triangles(&mut self, shape: &Shape) -> Option<Triangles> {
        let shape = match shape {
            Shape::Box { .. } => &Shape::cuboid(Vector3::repeat(1.0)),
            other => other,
        };
        if let Some((_, known)) = self.shapes.iter().find(|(known, _)| known == shape) {
            return Some(*known);
        }
        let triangles = match shape {
            Shape::Box { .. } => self.cube(),
            other => self.surface(&other.surface()?),
        };
        self.shapes.push((shape.clone(), triangles));
        Some(triangles)
    }

    fn surface(&mut self, surface: &Surface) -> Triangles {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for (face, corners) in surface.triangles() {
            for corner in corners {
                positions.push(vector(&surface.corners_m[corner]));
                normals.push(vector(&surface.rounded_normal(face, corner)));
            }
        }
        let triangles: Vec<usize> = (0..positions.len()).collect();
        self.mesh(&positions, &normals, &triangles)
    }

    /// A node with this shape, in the frame of its parent node; `None` for a shape without a surface.
    fn solid(&mut self, solid: &Solid, alpha: f64) -> Option<usize> {
        let cube = self.triangles(&solid.shape)?;
        let half_m = match solid.shape {
            Shape::Box { half_extents_m } => half_extents_m,
            _ => Vector3::repeat(1.0),
        };
        let material = self.material(solid.kind, alpha);
        let primitive = json!({
            "attributes": { "POSITION": cube.positions, "NORMAL": cube.normals },
            "indices": cube.triangles,
            "material": material,
        });
        let mesh = json!({ "primitives": [primitive] });
        let known = self.meshes.iter().position(|known| *known == mesh);
        let mesh = known.unwrap_or_else(|| {
            self.meshes.push(mesh);
            self.meshes.len() - 1
        });
        let is_floor = solid.kind == Kind::Floor;
        let name = match solid.shape {
            _ if is_floor => "floor",
            Shape::Box { .. } => "box",
            Shape::Sphere { .. } => "sphere",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Capsule { .. } => "capsule",
            Shape::Hull { .. } | Shape::Nothing => "hull",
        };
        Some(self.node(json!({
            "name": name,
            "mesh": mesh,
            "translation": vector(&solid.pose.translation.vector),
            "rotation": quaternion(&solid.pose.rotation),
            "scale": vector(&half_m),
        })))
    }

    /// The nodes of a run.
    fn actor(&mut self, actor: &Actor) -> Vec<usize> {
        let times: Vec<Vec<f32>> = actor.times_s.iter().map(|t| vec![*t as f32]).collect();
        let times = self.accessor(&times, "SCALAR");
        let mut all = Vec::new();
        for mover in &actor.movers {
            let solids = mover.solids.iter();
            let solids = solids.filter_map(|solid| self.solid(solid, actor.alpha()));
            let solids: Vec<usize> = solids.collect();
            let name = format!("{}/{}", actor.name, mover.name);
            all.push(self.moving(&name, solids, times, mover.poses.iter().copied()));
        }
        if actor.movers.is_empty() {
            let point = Solid {
                shape: Shape::cuboid(Vector3::repeat(POINT_HALF_M)),
                pose: Isometry3::identity(),
                kind: actor.kind(),
            };
            let point = self.solid(&point, 1.0).into_iter().collect();
            let places = actor.places_m.iter();
            let poses =
                places.map(|place| Isometry3::from_parts((*place).into(), Default::default()));
            all.push(self.moving(&actor.name, point, times, poses));
        }
        let places: Vec<Vec<f32>> = actor.places_m.iter().map(vector).collect();
        let positions = self.accessor(&places, "VEC3");
        let material = self.material(actor.kind(), 1.0);
        self.meshes.push(json!({ "primitives": [{
            "attributes": { "POSITION": positions },
            "mode": LINE_STRIP,
            "material": material,
        }]}));
        let name = format!("{}/path", actor.name);
        let mesh = self.meshes.len() - 1;
        all.push(self.node(json!({ "name": name, "mesh": mesh })));
        all
    }

    /// A node that moves.
    fn moving(
        &mut self,
        name: &str,
        children: Vec<usize>,
        times: usize,
        poses: impl Iterator<Item = Isometry3<f64>> + Clone,
    ) -> usize {
        // Programs that do not play animations show the start.
        let start = poses.clone().next().unwrap_or_default();
        let mut node = json!({
            "name": name,
            "translation": vector(&start.translation.vector),
            "rotation": quaternion(&start.rotation),
        });
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        let node = self.node(node);
        let places: Vec<Vec<f32>> = poses
            .clone()
            .map(|pose| vector(&pose.translation.vector))
            .collect();
        let turns = continuous(poses.map(|pose| pose.rotation));
        let turns: Vec<Vec<f32>> = turns.map(|turn| quaternion(&turn)).collect();
        for (path, rows, kind) in [("translation", places, "VEC3"), ("rotation", turns, "VEC4")] {
            let output = self.accessor(&rows, kind);
            self.samplers
                .push(json!({ "input": times, "output": output, "interpolation": "LINEAR" }));
            let sampler = self.samplers.len() - 1;
            self.channels
                .push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
        }
        node
    }

    /// The whole file.
    fn finish(self, root: usize, stage: &Stage) -> Vec<u8> {
        let generator = concat!("realgap ", env!("CARGO_PKG_VERSION"));
        let document = json!({
            "asset": { "version": "2.0", "generator": generator },
            "scene": 0,
            "scenes": [{ "nodes": [root] }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.bytes.len() }],
            "animations": [{ "name": stage.actors[0].name, "samplers": self.samplers, "channels": self.channels }],
        });
        let mut text = document.to_string().into_bytes();
        while !text.len().is_multiple_of(4) {
            text.push(b' ');
        }
        let chunks = [(b"JSON", text), (b"BIN\0", self.bytes)];
        let sizes = chunks.iter().map(|(_, bytes)| 8 + bytes.len());
        let length = 12 + sizes.sum::<usize>();
        let mut file = b"glTF".to_vec();
        file.extend(2_u32.to_le_bytes());
        file.extend((length as u32).to_le_bytes());
        for (kind, bytes) in chunks {
            file.extend((bytes.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(bytes);
        }
        file
    }
}

fn vector(v: &Vector3<f64>) -> Vec<f32> {
    v.iter().map(|value| *value as f32).collect()
}

/// With its real part last.
fn quaternion(q: &UnitQuaternion<f64>) -> Vec<f32> {
    [q.i, q.j, q.k, q.w].map(|value| value as f32).to_vec()
}
