"""Materials of the input files of CalculiX and Abaqus: which keywords are theirs, and what is linear elastic."""

from __future__ import annotations

import re
from collections.abc import Sequence

from slmm.mechanics.elasticity import Elasticity
from slmm.results.inp_lines import Block, plain, real

#: options of a material that leave it linear elastic
HARMLESS = re.compile(
    "CONDUCTIVITY|DAMPING|DENSITY|ELECTRICALCONDUCTIVITY|MAGNETICPERMEABILITY|SPECIFICGASCONSTANT|SPECIFICHEAT"
)

#: keywords that end the options of a material; any other is taken for one, so that no option is passed over
AFTER_MATERIAL = re.compile(
    ".*SECTION|AMPLITUDE|BOUNDARY|CLEARANCE|CONTACT.*|CONTROLS|COUPLING|CYCLICSYMMETRYMODEL|DASHPOT|DESIGNVARIABLES|"
    "DISTRIBUTING.*|DISTRIBUTION|ELEMENT|ELSET|EQUATION|FRICTION|GAP|HEADING|INITIALCONDITIONS|KINEMATIC|MASS|"
    "MATERIAL|MPC|NODALTHICKNESS|NODE|NORMAL|NSET|ORIENTATION|PHYSICALCONSTANTS|PREPRINT|RESTART|RIGIDBODY|SPRING|"
    "STEP|SUBMODEL|SURFACE.*|TIE|TIMEPOINTS|TRANSFORM|VALUESATINFINITY"
)

#: options of a material wherever they stand before the first step: CalculiX sorts its keywords
OPTIONS = re.compile(
    "CONDUCTIVITY|CREEP|CYCLICHARDENING|DAMAGEINITIATION|DAMPING|DEFORMATIONPLASTICITY|DENSITY|DEPVAR|ELASTIC|"
    "ELECTRICALCONDUCTIVITY|EXPANSION|FLUIDCONSTANTS|HYPERELASTIC|HYPERFOAM|MAGNETICPERMEABILITY|MOHRCOULOMB.*|"
    "PLASTIC|RATEDEPENDENT|SPECIFICGASCONSTANT|SPECIFICHEAT|USERMATERIAL"
)


def elasticity(material: str, options: Sequence[Block]) -> tuple[Elasticity | None, str]:
    """The elasticity of a material, or why there is none.

    Parameters
    ----------
    material : str
        Its name.
    options : sequence of Block
        The keywords that belong to it.

    Raises
    ------
    ValueError
        When constants are missing, no numbers, or out of range; the message names the line.
    """
    other = [b for b in options if b.keyword != "ELASTIC" and not HARMLESS.fullmatch(b.keyword)]
    elastic = [block for block in options if block.keyword == "ELASTIC"]
    if other:
        return None, f"{material} has {other[0].called}"
    if not elastic:
        return None, f"{material} has no *ELASTIC"
    line, data = elastic[-1].line, elastic[-1].data
    kind = plain(elastic[-1].parameters.get("TYPE", "ISO"))
    if kind not in ("ISO", "ISOTROPIC"):
        return None, f"{material} has *ELASTIC, TYPE={kind}"
    if len(data) > 1:
        return None, f"{material} has *ELASTIC for {len(data)} temperatures"
    if not data or len(data[0].fields) < 2:
        raise line.error("*ELASTIC needs Young's modulus and Poisson's ratio")
    E, nu, *_ = data[0].numbers(real)
    try:
        return Elasticity(E, nu), ""
    except ValueError as error:
        raise data[0].error(str(error)) from error
