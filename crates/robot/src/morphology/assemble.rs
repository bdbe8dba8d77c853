//! Assembly of a modular robot: combines attached modules into rigid parts that hinges connect.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

use super::Morphology;
use super::assembly::{Assembly, Bearing, Freedom, Hinge, Part, Role, Solid};
use super::body::Surroundings;
use super::layout::{Placement, plate_box};
use super::module::{Drive, DriveAxis, Module};
use super::tree::{Edge, is_attached};
use realgap_solid::Shape;

/// The assembly while it is being built, and the part that each module's cube belongs to.
struct AssemblyBuilder<'a> {
    morphology: &'a Morphology,
    parts: Vec<Part>,
    hinges: Vec<Hinge>,
    cube_part: Vec<usize>,
}

pub(super) fn assemble(morphology: &Morphology) -> Assembly {
    let modules = morphology.modules();
    let mut builder = AssemblyBuilder {
        morphology,
        parts: vec![Part { solids: Vec::new() }],
        hinges: Vec::new(),
        cube_part: vec![0; modules.len()],
    };
    for &module in &morphology.tree.order {
        builder.add(module);
    }
    let track = morphology.track();
    Assembly {
        name: morphology.name().to_owned(),
        module_names: modules.iter().map(|module| module.name.clone()).collect(),
        parts: builder.parts,
        hinges: builder.hinges,
        is_modular: true,
        collision_exclude: morphology.collision_exclude.clone(),
        world_from_mount: morphology
            .mount_world_m
            .map(|mount_m| Isometry3::from_parts(mount_m.into(), UnitQuaternion::identity())),
        marks: Vec::new(),
        track_part: builder.cube_part[track],
        robot_from_track: morphology.placements[track].pose_of(Vector3::zeros()),
        body_length_m: modules[track].sides_m.max(),
        surroundings: Surroundings::default(),
    }
}

impl AssemblyBuilder<'_> {
    /// Adds a module to its existing part, and creates the parts of its children.
    fn add(&mut self, index: usize) {
        let morphology = self.morphology;
        let module = &morphology.modules()[index];
        let placement = &morphology.placements[index];
        let part = self.cube_part[index];
        self.parts[part]
            .solids
            .extend(boxes(index, module, placement));
        if let Some(drive) = &module.drive
            && !is_attached(morphology.attachments(), index, drive.face)
        {
            let free = self.create_part(index, part, drive, 1.0);
            self.add_plate(index, free, true);
        }
        for &edge in &morphology.tree.children[index] {
            let attachment = match edge {
                Edge::Attachment(attachment) => &morphology.attachments()[attachment],
                Edge::Pivot(pivot) => {
                    self.create_pivot_part(pivot, part);
                    continue;
                }
            };
            let child = &morphology.modules()[attachment.child];
            self.cube_part[attachment.child] = match (&module.drive, &child.drive) {
                (Some(drive), _) if drive.face == attachment.face => {
                    let moved = self.create_part(index, part, drive, 1.0);
                    self.add_plate(index, moved, false);
                    moved
                }
                (_, Some(drive)) if drive.face == attachment.child_face => {
                    // The child is attached by its driven face: its plate belongs to the parent's part, and its cube turns in the
                    // opposite direction.
                    self.add_plate(attachment.child, part, false);
                    self.create_part(attachment.child, part, drive, -1.0)
                }
                _ => part,
            };
        }
    }

    /// Creates a new part that the servo of `module` moves relative to `parent_part`. `sign` is −1 if the servo's cube belongs to
    /// the child part of the hinge.
    fn create_part(
        &mut self,
        module: usize,
        parent_part: usize,
        drive: &Drive,
        sign: f64,
    ) -> usize {
        let placement = &self.morphology.placements[module];
        let normal = drive.face.normal();
        let axis_module = match drive.axis {
            DriveAxis::Normal { .. } => normal,
            DriveAxis::Tangent { axis } => axis.normal(),
        };
        let half_side_m = self.morphology.modules()[module].sides_m[drive.face.axis_index()] / 2.0;
        let child_part = self.parts.len();
        self.parts.push(Part { solids: Vec::new() });
        self.hinges.push(Hinge {
            name: self.morphology.modules()[module].name.clone(),
            module,
            parent_part,
            child_part,
            anchor_robot_m: placement.point(normal * half_side_m),
            axis_robot: Unit::new_unchecked(placement.robot_from_module.apply(axis_module * sign)),
            freedom: Freedom::Turn,
            actuator: Some(drive.actuator),
            bearing: Bearing::default(),
            is_stated: false,
            start_rad: None,
        });
        child_part
    }

    /// Creates the part that holds the child of a stated hinge.
    fn create_pivot_part(&mut self, index: usize, parent_part: usize) {
        let pivot = &self.morphology.pivots()[index];
        let placement = &self.morphology.placements[pivot.parent];
        let child_part = self.parts.len();
        self.cube_part[pivot.child] = child_part;
        self.parts.push(Part { solids: Vec::new() });
        self.hinges.push(Hinge {
            name: pivot.name.clone(),
            module: pivot.child,
            parent_part,
            child_part,
            anchor_robot_m: placement.point(pivot.anchor_parent_m),
            axis_robot: Unit::new_unchecked(
                placement
                    .robot_from_module
                    .apply(pivot.axis_parent.into_inner()),
            ),
            freedom: Freedom::Turn,
            actuator: pivot.actuator,
            bearing: pivot.bearing,
            is_stated: true,
            start_rad: None,
        });
    }

    fn add_plate(&mut self, index: usize, part: usize, collides: bool) {
        let module = &self.morphology.modules()[index];
        if let (Some(plate), Some((centre, half))) = (module.plate(), plate_box(module)) {
            let pose = self.morphology.placements[index].pose_of(centre);
            self.parts[part]
                .solids
                .push(plate_solid(index, pose, half, plate.mass_kg, collides));
        }
    }
}

fn boxes(index: usize, module: &Module, placement: &Placement) -> impl Iterator<Item = Solid> {
    let masses = module.box_masses();
    let boxes = module.solid_boxes().into_iter().zip(masses).enumerate();
    boxes.map(
        move |(number, (part, (mass_kg, centre_m, inertia_kg_m2)))| Solid {
            module: index,
            role: Role::Cube,
            number,
            shape: Shape::cuboid(part.sides_m / 2.0),
            robot_from_solid: placement.pose_of(part.centre_m),
            mass_kg,
            centre_of_mass_solid_m: centre_m - part.centre_m,
            inertia_kg_m2,
            gravity_compensation: 0.0,
            collides: true,
            tyre: None,
            turning: Default::default(),
        },
    )
}

fn plate_solid(
    module: usize,
    robot_from_solid: Isometry3<f64>,
    half_extents_m: Vector3<f64>,
    mass_kg: f64,
    collides: bool,
) -> Solid {
    let square = half_extents_m.component_mul(&half_extents_m);
    // Moment of a uniform box: m/3 times the sum of the squared half extents across the axis.
    let moments = Vector3::repeat(square.sum()) - square;
    Solid {
        module,
        role: Role::Plate,
        number: 0,
        shape: Shape::cuboid(half_extents_m),
        robot_from_solid,
        mass_kg,
        centre_of_mass_solid_m: Vector3::zeros(),
        inertia_kg_m2: nalgebra::Matrix3::from_diagonal(&(moments * (mass_kg / 3.0))),
        gravity_compensation: 0.0,
        collides,
        tyre: None,
        turning: Default::default(),
    }
}
