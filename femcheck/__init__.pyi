"""Public names; `public_names` and type checkers read this list."""

from .accuracy.ending import Ending as Ending
from .accuracy.ending import Within as Within
from .accuracy.within import answer_within as answer_within
from .chart.campaign import run_chart as run_chart
from .chart.chart import Chart as Chart
from .check.check_design import check_design as check_design
from .check.checked import Checked as Checked
from .check.comparison import Comparison as Comparison
from .check.options import CheckOptions as CheckOptions
from .continuation.outcome import Status as Status
from .material.catalogue import law_by_name as law_by_name
from .material.fibre import Thread as Thread
from .material.law import Law as Law
from .material.rigid_section import RigidSection as RigidSection
from .mesh.geo import SectionSizes as SectionSizes
from .mesh.gmsh_section import Mesher as Mesher
from .mesh.gmsh_section import MeshFailure as MeshFailure
from .mesh.gmsh_section import MeshProblem as MeshProblem
from .models.question import Question as Question
from .prediction.options import PredictionOptions as PredictionOptions
from .prediction.predict_design import predict_design as predict_design
from .prediction.prediction import Prediction as Prediction
from .prediction.verdict import verdict as verdict
from .solid.winding import Wound as Wound
from .solved.subject import LoadedDesignError as LoadedDesignError
from .solved.subject import Subject as Subject
from .solved.subject import UnsealedDesignError as UnsealedDesignError
from .solved.subject import sealed_copy as sealed_copy
from .solved.subject import slender_copy as slender_copy

__version__: str
