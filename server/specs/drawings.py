"""Convert the drawing of a spec to its wire type."""

from microcosmos.spec import Drawing, targets

from .schemas import BodyRead, DrawingRead, PictureRead

DECIMALS = 3


def drawing_read(drawing: Drawing) -> DrawingRead:
    bodies = [
        BodyRead(
            name=body.name,
            nodes=body.nodes,
            positions=body.positions.round(DECIMALS).tolist(),
            edges=body.edges.tolist(),
            whole=body.whole,
        )
        for body in drawing.bodies
    ]
    shown = [
        PictureRead(
            name=name, width=ink.shape[1], height=ink.shape[0], pixels=targets.encoded(ink)
        )
        for name, ink in drawing.pictures
    ]
    return DrawingRead(
        width=drawing.width,
        height=drawing.height,
        bodies=bodies,
        pictures=shown,
        picture_size=drawing.picture_size,
    )
