"""The meshes that shipped scenes name and that are not ours: whose they are, on what terms, and where they are from."""

from __future__ import annotations

from dataclasses import dataclass

from scenes.meshes.files import MeshFile, sha256
from scenes.meshes.notes import Note, read_note
from scenes.meshes.steps import Step


@dataclass(frozen=True)
class Original:
    """A file as its makers publish it.

    Attributes
    ----------
    address : str   of the archive that holds it
    member : str    its file name in the archive, without folders
    sha256 : str    of the unpacked file, hexadecimal
    """

    address: str
    member: str
    sha256: str


@dataclass(frozen=True)
class KnownMesh:
    """A mesh that scenes may name.

    Attributes
    ----------
    what : str                 what it shows
    credit : str               whom to name where it is shown
    licence : str              the terms stated where it is published
    origin : str               who publishes it
    page : str                 the address to look at
    reference_sha256 : str     of the copy with which the results of this repository were made
    original : Original        what `airlight meshes fetch` makes it from; None where no original with a known hash is
    steps : tuple of Step      how it is made from the original
    """

    what: str
    credit: str
    licence: str
    origin: str
    page: str
    reference_sha256: str
    original: Original | None = None
    steps: tuple[Step, ...] = ()


STANFORD = "Stanford 3D Scanning Repository", "http://graphics.stanford.edu/data/3Dscanrep/"
STANFORD_CREDIT = "Stanford Computer Graphics Laboratory"
STANFORD_TERMS = "research use with credit to the Stanford Computer Graphics Laboratory; no commercial use"
DRAGON_ARCHIVE = "http://graphics.stanford.edu/pub/3Dscanrep/dragon/dragon_recon.tar.gz"
CRANE = "Keenan Crane's model repository", "https://www.cs.cmu.edu/~kmcrane/Projects/ModelRepository/"
YEAHRIGHT = Original(
    "https://www.cs.cmu.edu/~kmcrane/Projects/ModelRepository/yeahright.zip",
    "controlmesh.obj",
    "bf8768bf019ac505c39c92ae5d63808ee1773047aefd5d5d6700b88c1b5f1c3e",
)

# Both dragons come out closed, in one shell, with 96,896 and 45,576 triangles. Measured with 400,000 points on either
# surface: none of the mesh's is farther than 0.4 % of the diagonal from the original's (as far as the points lie
# apart), and 0.15 % of the coarse original's are farther than 0.5 % from the mesh: small patches that the repair drops.
MESHES: dict[str, KnownMesh] = {
    "dragon_97k_fixed.ply": KnownMesh(
        "Stanford dragon, decimated and repaired",
        STANFORD_CREDIT,
        STANFORD_TERMS,
        *STANFORD,
        "3ba0bc03154feba699a81f3485260cfb2472bad5f86f93f846069af9151c18e5",
        Original(
            DRAGON_ARCHIVE,
            "dragon_vrip.ply",
            "fea87ff48f2aba22fb53e7b67c3ff3f7b8c2a3b3a0653af62c48bba67c6d5744",
        ),
        (Step("decimate", {"target": 97_716}), Step("repair")),
    ),
    "dragon_res3_fixed.ply": KnownMesh(
        "Stanford dragon as Stanford decimated it, repaired",
        STANFORD_CREDIT,
        STANFORD_TERMS,
        *STANFORD,
        "ccd4512df4835276ff12791adbc31f33587a28f473719694c773db526b86a500",
        Original(
            DRAGON_ARCHIVE,
            "dragon_vrip_res3.ply",
            "f32b87762894bde78cd45dc05aa9fde0f5ad390c944168a96e97191ff1fc6d45",
        ),
        (Step("repair"),),
    ),
    "yeahright_cc2.ply": KnownMesh(
        "YeahRight, its control mesh subdivided twice; genus 131",
        "Keenan Crane",
        "public domain",
        *CRANE,
        "7a7e48b097c6e1b41c528bf20399fdb8e5d5df0a470b71f58bee0e716aaffd0c",
        YEAHRIGHT,
        (Step("catmull_clark", {"levels": 2}),),
    ),
    "yeahright_cc1.ply": KnownMesh(
        "YeahRight, its control mesh subdivided once; genus 131",
        "Keenan Crane",
        "public domain",
        *CRANE,
        "0d793666ea116c905dd2e204f8d6c4e1308fa06d0b84db1bb2d2030e04bd8a82",
        YEAHRIGHT,
        (Step("catmull_clark", {"levels": 1}),),
    ),
    "bunny_hr.ply": KnownMesh(
        "Stanford bunny, closed",
        STANFORD_CREDIT,
        STANFORD_TERMS,
        *STANFORD,
        "661003997eb4f94ee969d006d690d1de2d9ae0e245fa69a09867c1331fa7766f",
    ),
    "armadillo_29k.ply": KnownMesh(
        "Stanford armadillo, decimated",
        STANFORD_CREDIT,
        STANFORD_TERMS,
        *STANFORD,
        "0ad5926d30bbe9bc38fdcfe4eccf31d17a287e7af9c21e6ba6c22fdfed17094e",
    ),
    "spot.ply": KnownMesh(
        "Spot the cow",
        "Keenan Crane",
        "public domain",
        *CRANE,
        "e254144e502fc009e13ae25bc4a570e12f810d8634a7aa130b2231094e61adb0",
    ),
    "scorpion.ply": KnownMesh(
        "scorpion",
        "YahooJAPAN",
        "CC BY 3.0",
        "Oded Stein's meshes",
        "https://github.com/odedstein/meshes",
        "18531b10ba73e719718424f68327ac1a91d658067aab0ee4f6e6bf0fc3021666",
    ),
    "fertility.ply": KnownMesh(
        "Fertility",
        "AIM@SHAPE",
        "not stated",
        "libigl's tutorial data",
        "https://github.com/libigl/libigl-tutorial-data",
        "777e6331a24d7b0b68818d8bb3d11d4c4f70395fe3ff83f040f512274bca4644",
    ),
    "teapot.ply": KnownMesh(
        "Utah teapot, open at the lid",
        "Martin Newell",
        "not stated",
        "Alec Jacobson's common 3D test models",
        "https://github.com/alecjacobson/common-3d-test-models",
        "20fa648f1a65ad1b9201d4194ad666b0f850894ba4a27ca8c9d2b47dada0a020",
    ),
}


def made_as_now(note: Note) -> bool:
    """Whether a fetched mesh was made from the original and by the steps that MESHES has for it today."""
    known = MESHES.get(note.name)
    if known is None or known.original is None or note.original_sha256 != known.original.sha256:
        return False
    recorded = [(record.step, record.parameters) for record in note.steps]
    return recorded == [(step.name, step.parameters) for step in known.steps]


def how_to_get(name: str) -> str:
    """What a person does to have a mesh of MESHES in place of its stand-in, in some words."""
    known = MESHES[name]
    if known.original:
        return f"airlight meshes fetch {name}"
    return f"by hand from {known.origin}"


def is_reference_copy(mesh: MeshFile) -> bool:
    """Whether a mesh has the very bytes with which the results of this repository were made.

    Raises
    ------
    InputError   the file cannot be read
    """
    known = MESHES.get(mesh.name)
    return known is not None and mesh.path.is_file() and sha256(mesh.path) == known.reference_sha256


def credit(mesh: MeshFile) -> str | None:
    """Whom to name, and the terms, where a picture shows this mesh; one line.

    None for meshes that our code made and for a scene's own files that airlight does not know.

    Raises
    ------
    InputError   the file cannot be read
    """
    if mesh.origin in ("generated", "stand-in"):
        return None
    note = read_note(mesh.path)
    if note:
        return f"{mesh.name}: {note.credit} ({note.licence})"
    known = MESHES.get(mesh.name)
    if known is None:
        return None
    line = f"{mesh.name}: {known.credit} ({known.licence})"
    if is_reference_copy(mesh):
        return line
    # a scene's own teapot.ply is its author's; in a folder of meshes the name is what one goes by
    return None if mesh.origin == "scene" else f"{line}, by its name alone"
