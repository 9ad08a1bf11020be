//! What a failing call says.

use crate::records::{codes, Read};
use foliations_sys as sys;
use std::ffi::CStr;
use std::fmt;

/// `Result` with an [`Error`] of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// How a call ended. Values never change; new ones are added.
///
/// The classes are 10: stopped early, 100: the call itself, 200: resources,
/// 300: the mesh, 400: loops and weights, 500: values, 900: a defect of the library.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Status(i32);

macro_rules! statuses {
    ($($(#[$doc:meta])* $name:ident = $value:ident;)*) => {
        impl Status {
            $($(#[$doc])* pub const $name: Status = Status(sys::$value);)*

            fn name(self) -> Option<&'static str> {
                match self {
                    $(Status::$name => Some(stringify!($name)),)*
                    _ => None,
                }
            }
        }
    };
}

statuses! {
    /// Success.
    OK = HMF_OK;
    /// The iteration limit ended the optimization.
    LIMIT_ITERATIONS = HMF_LIMIT_ITERATIONS;
    /// The time limit ended the optimization.
    LIMIT_TIME = HMF_LIMIT_TIME;
    /// No further progress is possible above the tolerance.
    LIMIT_STALLED = HMF_LIMIT_STALLED;
    /// The progress closure ended the call.
    CANCELLED = HMF_CANCELLED;
    /// No step that stays in the class of the loops reaches the minimum; the element is
    /// a loop that the others lose. See [`Report::class_state`](crate::Report::class_state).
    LIMIT_CLASS = HMF_LIMIT_CLASS;
    /// A pointer that must not be null is; safe Rust does not meet it.
    ERROR_NULL = HMF_ERROR_NULL;
    /// An option is out of range.
    ERROR_OPTIONS = HMF_ERROR_OPTIONS;
    /// An array has the wrong length.
    ERROR_COUNT = HMF_ERROR_COUNT;
    /// No such level.
    ERROR_LEVEL = HMF_ERROR_LEVEL;
    /// Not available in this version.
    ERROR_UNSUPPORTED = HMF_ERROR_UNSUPPORTED;
    /// These leaves carry no good quads of this size.
    ERROR_QUADS = HMF_ERROR_QUADS;
    /// The global allocator has no memory left.
    ERROR_MEMORY = HMF_ERROR_MEMORY;
    /// The memory limit of the options was reached.
    ERROR_MEMORY_LIMIT = HMF_ERROR_MEMORY_LIMIT;
    /// No vertices or triangles, or more than 2^31 / 3.
    ERROR_MESH_COUNTS = HMF_ERROR_MESH_COUNTS;
    /// A triangle names a vertex that does not exist.
    ERROR_MESH_INDEX = HMF_ERROR_MESH_INDEX;
    /// A coordinate is infinite or not a number.
    ERROR_MESH_NOT_FINITE = HMF_ERROR_MESH_NOT_FINITE;
    /// A triangle names one vertex twice.
    ERROR_MESH_REPEATED_VERTEX = HMF_ERROR_MESH_REPEATED_VERTEX;
    /// A triangle without area.
    ERROR_MESH_DEGENERATE = HMF_ERROR_MESH_DEGENERATE;
    /// An edge with one triangle.
    ERROR_MESH_BOUNDARY = HMF_ERROR_MESH_BOUNDARY;
    /// An edge with three or more triangles.
    ERROR_MESH_NON_MANIFOLD_EDGE = HMF_ERROR_MESH_NON_MANIFOLD_EDGE;
    /// Neighboring triangles turn in opposite senses.
    ERROR_MESH_ORIENTATION = HMF_ERROR_MESH_ORIENTATION;
    /// A vertex with several fans of triangles.
    ERROR_MESH_NON_MANIFOLD_VERTEX = HMF_ERROR_MESH_NON_MANIFOLD_VERTEX;
    /// A vertex without a triangle.
    ERROR_MESH_UNUSED_VERTEX = HMF_ERROR_MESH_UNUSED_VERTEX;
    /// More than one connected component.
    ERROR_MESH_COMPONENTS = HMF_ERROR_MESH_COMPONENTS;
    /// Genus 0 with fewer than four marked vertices: no measured foliation.
    ERROR_MESH_GENUS = HMF_ERROR_MESH_GENUS;
    /// The surface intersects itself, so that inside and outside have no meaning.
    ERROR_MESH_NOT_EMBEDDED = HMF_ERROR_MESH_NOT_EMBEDDED;
    /// No flips make the mesh intrinsically Delaunay.
    ERROR_MESH_NOT_DELAUNAY = HMF_ERROR_MESH_NOT_DELAUNAY;
    /// No loops.
    ERROR_LOOP_COUNT = HMF_ERROR_LOOP_COUNT;
    /// A loop names an element that does not exist on its level.
    ERROR_LOOP_INDEX = HMF_ERROR_LOOP_INDEX;
    /// Consecutive elements of a loop are not neighbors.
    ERROR_LOOP_NOT_CLOSED = HMF_ERROR_LOOP_NOT_CLOSED;
    /// A loop crosses itself.
    ERROR_LOOP_NOT_SIMPLE = HMF_ERROR_LOOP_NOT_SIMPLE;
    /// Two loops cross.
    ERROR_LOOP_CROSSING = HMF_ERROR_LOOP_CROSSING;
    /// A loop bounds a disk.
    ERROR_LOOP_TRIVIAL = HMF_ERROR_LOOP_TRIVIAL;
    /// Two loops are freely homotopic.
    ERROR_LOOP_PARALLEL = HMF_ERROR_LOOP_PARALLEL;
    /// A weight is not finite, not positive, or the weights span more than 2^20.
    ERROR_LOOP_WEIGHT = HMF_ERROR_LOOP_WEIGHT;
    /// A value is negative, infinite or not a number.
    ERROR_VALUE_NOT_FINITE = HMF_ERROR_VALUE_NOT_FINITE;
    /// A triangle inequality is violated, or a value is not a multiple of the unit.
    ERROR_VALUE_NOT_CLOSED = HMF_ERROR_VALUE_NOT_CLOSED;
    /// The values have a pole.
    ERROR_VALUE_POLE = HMF_ERROR_VALUE_POLE;
    /// The values are too far from the minimum of the energy.
    ERROR_VALUE_NOT_HARMONIC = HMF_ERROR_VALUE_NOT_HARMONIC;
    /// The values are those of other loops than given, or their leaves do not close.
    ERROR_VALUE_CLASS = HMF_ERROR_VALUE_CLASS;
    /// A defect of the library itself; please report it.
    ERROR_INTERNAL = HMF_ERROR_INTERNAL;
}

impl Status {
    /// The number of the C interface.
    pub const fn code(self) -> i32 {
        self.0
    }

    pub(crate) const fn from_code(code: i32) -> Status {
        Status(code)
    }

    /// Whether the optimization was stopped before it converged: a limit or a
    /// cancellation.
    pub fn is_stopped(self) -> bool {
        (10..100).contains(&self.0)
    }
}

impl fmt::Debug for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => f.write_str(name),
            None => write!(f, "Status({})", self.0),
        }
    }
}

/// A short English text.
impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // SAFETY: any value is allowed; the text is static and ends with 0.
        let text = unsafe { CStr::from_ptr(sys::hmf_status_string(self.0)) };
        f.write_str(&text.to_string_lossy())
    }
}

codes! {
    /// What an error is about.
    Element: i32 {
        /// A vertex of the mesh or of a level.
        Vertex = sys::HMF_ELEMENT_VERTEX,
        /// An edge.
        Edge = sys::HMF_ELEMENT_EDGE,
        /// A triangle.
        Triangle = sys::HMF_ELEMENT_TRIANGLE,
        /// A loop of a set of loops.
        Loop = sys::HMF_ELEMENT_LOOP,
        /// A level of the hierarchy.
        Level = sys::HMF_ELEMENT_LEVEL,
        /// An option.
        Option = sys::HMF_ELEMENT_OPTION,
    }
}

/// Why a call failed: the status, the element it is about, and a sentence that
/// says what is wrong and what to do.
///
/// ```
/// use foliations::{Element, Hierarchy, Status};
///
/// // A vertex that does not exist.
/// let error = Hierarchy::build(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 3]]).unwrap_err();
/// assert_eq!(error.status(), Status::ERROR_MESH_INDEX);
/// assert_eq!(error.element(), Some(Element::Triangle));
/// println!("{error}");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    status: Status,
    element: Option<Element>,
    index: u64,
    message: String,
}

impl Error {
    /// How the call ended.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Kind of the element that the error is about.
    pub fn element(&self) -> Option<Element> {
        self.element
    }

    /// Number of the element, counted from 0; of the given point where a point is bad.
    pub fn index(&self) -> u64 {
        self.index
    }

    /// What is wrong and what to do.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// An option that is out of range.
    pub(crate) fn option(message: String) -> Error {
        Error { element: Some(Element::Option), ..Error::new(Status::ERROR_OPTIONS, message) }
    }

    /// A mesh that has a boundary, though it must not.
    pub(crate) fn not_closed(curves: &[Vec<u32>]) -> Error {
        let boundaries = if curves.len() == 1 { "boundary" } else { "boundaries" };
        let (count, edges) = (curves.len(), curves[0].len());
        let message = format!(
            "The mesh has {count} {boundaries}, the first with {edges} edges, and is to be closed. \
             Close it, or leave Builder::closed out."
        );
        let index = u64::from(curves[0][0]);
        Error { element: Some(Element::Vertex), index, ..Error::new(Status::ERROR_MESH_BOUNDARY, message) }
    }

    /// An error that this crate finds itself, before the call.
    pub(crate) fn new(status: Status, message: String) -> Error {
        Error { status, element: None, index: 0, message }
    }
}

/// The message, which is a sentence.
impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

/// What sentences of the C library call otherwise than this crate.
const WORDS: &[(&str, &str)] = &[
    (
        "hmf_hierarchy_options is unusable. Set struct_size to its size and unused fields to 0; ratio",
        "The builder cannot be used: its ratio",
    ),
    (", position_stride fits into memory, allocate and release come together", ""),
    ("set mollify in the build options", "set Builder::mollify to 1e-5"),
    ("HMF_METHOD_WHITEHEAD has none", "Method::Whitehead has none"),
    ("Use HMF_LOOPS_CUT or HMF_LOOPS_PANTS", "Use LoopsKind::Cut or LoopsKind::Pants"),
    ("use HMF_LOOPS_CUT or HMF_LOOPS_PANTS", "use LoopsKind::Cut or LoopsKind::Pants"),
    ("report->class_state", "report.class_state"),
    ("Build each component of hmf_components on its own", "Build each of Builder::components on its own"),
    ("Use hmf_loops, or another mesh", "Use other loops, or another mesh"),
    ("; hmf_singularities lists them", "; Foliation::singularities lists them"),
    (
        "Start from hmf_foliation_from_loops or a result of hmf_solve",
        "Start from Hierarchy::initialize or a result of a solve",
    ),
    ("; hmf_hierarchy_memory_estimate gives a sufficient value", "; Builder::memory_estimate gives a sufficient value"),
    ("with hmf_interpolate", "with Foliation::interpolate"),
    ("with hmf_relax", "with Solver::relax"),
    ("Give one of them, the other NULL", "Give one of them"),
];
const FOREIGN: [&str; 6] = ["hmf_", "HMF_", "NULL", "struct_size", "->", "position_stride"];

/// A sentence of the C library in the words of this crate; sentences with others are left out.
pub(crate) fn in_words(message: &str) -> String {
    let mut text = message.to_string();
    for (library, own) in WORDS {
        text = text.replace(library, own);
    }
    let known = |part: &&str| !FOREIGN.iter().any(|word| part.contains(word));
    let parts: Vec<&str> = text.split_inclusive(". ").map(str::trim).filter(known).collect();
    parts.join(" ")
}

/// The error of a status; `None` for success.
pub(crate) fn error_of(status: sys::hmf_status, raw: &sys::hmf_error) -> Option<Error> {
    let status = Status(status);
    if status == Status::OK {
        return None;
    }
    // SAFETY: the array is inside `raw`, and the library ends it with 0.
    let message = in_words(&unsafe { CStr::from_ptr(raw.message.as_ptr()) }.to_string_lossy());
    Some(Error {
        status,
        element: (raw.element != sys::HMF_ELEMENT_NONE).then(|| raw.element.read()),
        index: raw.index,
        message: if message.is_empty() { status.to_string() } else { message },
    })
}

#[cfg(test)]
mod tests {
    use super::{in_words, WORDS};
    use std::path::Path;

    /// The literals of each call that fails: what the library can say.
    fn messages(folder: &Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                messages(&path, found);
                continue;
            }
            let Ok(source) = std::fs::read_to_string(&path) else { continue };
            for call in source.split("fail(").skip(1) {
                // Literals are the odd parts; the call ends at a semicolon outside of them.
                let mut sentence = String::new();
                for (i, part) in call.split('"').enumerate() {
                    if i % 2 == 1 {
                        sentence += part;
                    } else if part.contains(';') {
                        break;
                    }
                }
                found.push(sentence);
            }
        }
        found.retain(|sentence| !sentence.is_empty());
    }

    /// No word of the C interface is left in a message of this crate.
    #[test]
    fn every_error_is_in_words_of_rust() {
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../src");
        if !sources.exists() {
            println!("skipped: the sources of the library are not here");
            return;
        }
        let mut found = Vec::new();
        messages(&sources, &mut found);
        assert!(found.len() > 100, "{} messages", found.len());
        for message in &found {
            let said = in_words(message);
            for word in ["hmf_", "HMF_", "NULL", "struct_size", "->", "build options", "optimis"] {
                assert!(!said.contains(word), "{message}: {said}");
            }
        }
        // A sentence that the library no longer says has no place in the table.
        for (words, _) in WORDS {
            assert!(found.iter().any(|message| message.contains(words)), "{words}");
        }
    }
}
