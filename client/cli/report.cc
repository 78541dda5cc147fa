#include "client/cli/report.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "client/cli/output.h"
#include "client/cli/plane_report.h"
#include "client/cli/report_lines.h"
#include "client/cpp/client.h"

namespace moduli::cli {
namespace {

std::string surfaceWords(const v1::Topology& topology) {
  std::string words = topology.has_genus() ? "genus " + std::to_string(topology.genus()) + ", "
                                           : std::string("no genus, ");
  words += topology.boundary_loops() == 0
               ? "closed"
               : counted(topology.boundary_loops(), "boundary loop", "boundary loops");
  words += ", " + counted(topology.components(), "component", "components");
  if (!topology.orientable()) words += ", not orientable";
  return words;
}

std::string topologyLines(const v1::Topology& topology) {
  return line("surface", surfaceWords(topology)) +
         line("size", counted(topology.vertices(), "vertex", "vertices") + ", " +
                          counted(topology.faces(), "face", "faces") + ", Euler characteristic " +
                          std::to_string(topology.euler_characteristic())) +
         line("area", brief(topology.area()));
}

std::string firstElements(const v1::Defect& defect) {
  constexpr int kShown = 8;
  std::string text;
  for (int i = 0; i < defect.elements_size() && i < kShown; ++i) {
    text += (i == 0 ? "" : " ") + std::to_string(defect.elements(i));
  }
  return defect.count() > kShown ? text + " ..." : text;
}

std::string errorText(bool has, double error) {
  return has ? "   (error at most " + brief(error) + ")" : "";
}

// The matrix row by row while it fits a terminal, its size alone past that.
std::string matrixLines(const v1::ConformalBlock& block) {
  constexpr int kShown = 4;
  const v1::ComplexMatrix& matrix = block.period_matrix();
  const std::string size = std::to_string(matrix.size()) + " x " + std::to_string(matrix.size());
  std::string text =
      line("periods", size + errorText(block.has_period_error(), block.period_error()));
  if (matrix.size() > kShown) return text;
  for (int row = 0; row < matrix.size(); ++row) {
    std::string entries;
    for (int column = 0; column < matrix.size(); ++column) {
      std::string entry = complexText(matrix.entries(row * matrix.size() + column));
      entry.resize(std::max<std::size_t>(entry.size() + 2, 28), ' ');
      entries += entry;
    }
    text += line("", entries.substr(0, entries.find_last_not_of(' ') + 1));
  }
  return text;
}

std::string circleLines(const google::protobuf::RepeatedPtrField<v1::Circle>& circles) {
  constexpr int kShown = 6;
  std::string text;
  for (int n = 0; n < std::min(kShown, circles.size()); ++n) {
    text += line(n == 0 ? "circles" : "", "radius " + brief(circles[n].radius()) + " around " +
                                              complexText(circles[n].center()));
  }
  if (circles.size() > kShown) {
    text += line("", "and " + std::to_string(circles.size() - kShown) + " more");
  }
  return text;
}

std::string conformalLines(const v1::ConformalBlock& block) {
  std::string text = line("type", v1::ConformalBlock::Type_Name(block.type()));
  if (block.has_tau()) {
    text +=
        line("tau", complexText(block.tau()) + errorText(block.has_tau_error(), block.tau_error()));
  }
  if (block.has_modulus()) {
    text += line("modulus", brief(block.modulus()) +
                                errorText(block.has_modulus_error(), block.modulus_error()));
  }
  if (block.has_period_matrix()) text += matrixLines(block);
  if (block.energy_spectrum_size() > 0) {
    std::string energies = spectrumText(block.energy_spectrum());
    if (block.has_energy_spectrum_error()) {
      energies += "   (relative error at most " + brief(block.energy_spectrum_error()) + ")";
    }
    text += line("energies", energies);
  }
  if (block.length_spectrum_size() > 0) {
    text += line("geodesics", spectrumText(block.length_spectrum()));
  }
  if (block.boundary_lengths_size() > 0) {
    text += line("boundary", "geodesics of length " + spectrumText(block.boundary_lengths()));
  }
  if (block.has_fenchel_nielsen()) {
    text += line("pants", "lengths " + spectrumText(block.fenchel_nielsen().lengths()));
    text += line("", "twists " + spectrumText(block.fenchel_nielsen().twists()));
  }
  return text + circleLines(block.circles());
}

std::string warningLines(const google::protobuf::RepeatedPtrField<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += line("warning", safe(warning));
  return text;
}

// Of any certificate: the fields have the same names in all of them.
template <typename Certificate>
std::vector<std::string> mapParts(const Certificate& certificate) {
  std::vector<std::string> parts;
  if (certificate.has_flipped_faces()) {
    parts.push_back(counted(certificate.flipped_faces(), "flipped face", "flipped faces"));
  }
  if (certificate.has_mean_dilatation()) {
    parts.push_back("dilatation " + brief(certificate.mean_dilatation()) + " on average");
  }
  if (certificate.has_max_dilatation()) {
    parts.push_back(brief(certificate.max_dilatation()) + " at most");
  }
  if (certificate.has_layout_closure()) {
    parts.push_back("layout closes to " + brief(certificate.layout_closure()));
  }
  if (certificate.has_mollification() && certificate.mollification() > 0) {
    parts.push_back("edges lengthened by " + brief(certificate.mollification()) + " of their mean");
  }
  return parts;
}

std::string certificateLines(const v1::SignatureCertificate& certificate) {
  std::vector<std::string> parts = mapParts(certificate);
  if (certificate.has_riemann_bilinear_residual()) {
    parts.push_back("bilinear residual " + brief(certificate.riemann_bilinear_residual()));
  }
  if (certificate.has_spectrum_complete_to()) {
    parts.push_back("geodesics complete up to " + brief(certificate.spectrum_complete_to()));
  }
  if (certificate.has_relation_residual()) {
    parts.push_back("relation of the generators to " + brief(certificate.relation_residual()));
  }
  if (certificate.has_curvature_residual()) {
    parts.push_back("hyperbolic metric flat up to " + brief(certificate.curvature_residual()) +
                    " after " +
                    counted(certificate.newton_iterations(), "Newton step", "Newton steps"));
  }
  return joinedLine("quality", parts) + warningLines(certificate.warnings());
}

std::string metricLine(const v1::ParameterizationCertificate& certificate) {
  std::vector<std::string> parts;
  if (certificate.has_curvature_residual()) {
    parts.push_back("curvatures as wanted up to " + brief(certificate.curvature_residual()));
  }
  if (certificate.has_gauss_bonnet_residual()) {
    parts.push_back("their sum up to " + brief(certificate.gauss_bonnet_residual()));
  }
  if (certificate.has_newton_iterations()) {
    parts.push_back(counted(certificate.newton_iterations(), "iteration", "iterations"));
  }
  if (certificate.has_flips()) {
    parts.push_back(counted(certificate.flips(), "flipped edge", "flipped edges"));
  }
  if (certificate.has_smallest_angle()) {
    parts.push_back("smallest angle " + brief(certificate.smallest_angle()));
  }
  if (certificate.has_clamped_fraction()) {
    parts.push_back(brief(certificate.clamped_fraction()) + " of the edges clamped");
  }
  if (certificate.has_sweeps()) {
    parts.push_back(counted(certificate.sweeps(), "sweep", "sweeps") + " over the loops");
  }
  if (certificate.has_convergence_rate()) {
    parts.push_back("each shrinks the error by " + brief(certificate.convergence_rate()));
  }
  if (certificate.has_cycle_residual()) {
    parts.push_back("turns around vertices to " + brief(certificate.cycle_residual()));
  }
  if (certificate.has_relation_residual()) {
    parts.push_back("relation of the generators to " + brief(certificate.relation_residual()));
  }
  if (certificate.has_spectrum_complete_to()) {
    parts.push_back("geodesics complete up to " + brief(certificate.spectrum_complete_to()));
  }
  if (certificate.has_holonomy_residual()) {
    parts.push_back("holonomy to " + brief(certificate.holonomy_residual()));
  }
  if (certificate.has_boundary_deviation()) {
    parts.push_back("boundary in place up to " + brief(certificate.boundary_deviation()));
  }
  return joinedLine("metric", parts);
}

// How far the map is from an isometry.
std::string mapQualityLine(const v1::ParameterizationCertificate& certificate) {
  std::vector<std::string> parts;
  if (certificate.has_flipped_faces()) {
    parts.push_back(counted(certificate.flipped_faces(), "flipped face", "flipped faces"));
  }
  if (certificate.has_mean_dilatation()) {
    parts.push_back("dilatation " + brief(certificate.mean_dilatation()) + " on average");
  }
  if (certificate.has_dilatation_95()) {
    parts.push_back(brief(certificate.dilatation_95()) + " or less on 95 % of the area");
  }
  if (certificate.has_max_dilatation()) {
    parts.push_back(brief(certificate.max_dilatation()) + " at most");
  }
  if (certificate.has_area_distortion()) {
    parts.push_back("areas change by e^" + brief(certificate.area_distortion()));
  }
  return joinedLine("quality", parts);
}

std::string layoutLines(const v1::Parameterization& result) {
  const v1::ParameterizationCertificate& certificate = result.certificate();
  std::vector<std::string> parts;
  if (result.has_layout()) {
    const v1::LayoutMeasures& layout = result.layout();
    std::string faces = counted(layout.mapped_faces(), "face", "faces");
    if (layout.mapped_faces() != layout.faces()) {
      faces =
          std::to_string(layout.mapped_faces()) + " of " + counted(layout.faces(), "face", "faces");
    }
    parts.push_back(faces);
    parts.push_back(counted(layout.islands(), "island", "islands"));
    parts.push_back(layout.seam_length() > 0
                        ? "seams of " + brief(layout.seam_length()) + " times the root of the area"
                        : "no seams");
  }
  if (certificate.has_layout_closure()) {
    parts.push_back("closes to " + brief(certificate.layout_closure()));
  }
  if (certificate.has_mollification() && certificate.mollification() > 0) {
    parts.push_back("edges lengthened by " + brief(certificate.mollification()) + " of their mean");
  }
  return joinedLine("layout", parts);
}

std::string hyperbolicLines(const v1::HyperbolicDomain& domain) {
  google::protobuf::RepeatedField<double> lengths;
  for (const v1::ClosedGeodesic& geodesic : domain.geodesics()) lengths.Add(geodesic.length());
  std::string text =
      line("domain", "reaches " + brief(domain.radius()) + " from its centre, " +
                         counted(domain.neighbours_size(), "neighbour", "neighbours"));
  if (!lengths.empty()) text += line("geodesics", spectrumText(lengths));
  if (domain.boundary_lengths_size() > 0) {
    text += line("boundary", "geodesics of length " + spectrumText(domain.boundary_lengths()));
  }
  return text;
}

std::string domainLines(const v1::Parameterization& result) {
  std::string text;
  if (result.has_method()) {
    text += line("method", v1::ParameterizationOptions::Method_Name(result.method()));
  }
  if (result.has_modulus()) text += line("modulus", brief(result.modulus()));
  text += circleLines(result.circles());
  if (result.has_hyperbolic()) text += hyperbolicLines(result.hyperbolic());
  text += planeLines(result);
  if (result.refined()) {
    text += line("refined", counted(result.added_vertices(), "vertex", "vertices") + " and " +
                                counted(result.added_faces(), "face", "faces") + " added");
  }
  return text;
}

std::string registrationLines(const v1::RegistrationResult& registration) {
  std::vector<std::string> parts;
  if (registration.landmarks() > 0) {
    parts.push_back(counted(registration.landmarks(), "landmark", "landmarks") + " met up to " +
                    brief(registration.landmark_distance()));
  } else {
    parts.emplace_back("by a rotation");
  }
  if (registration.has_mean_beltrami()) {
    parts.push_back("|mu| " + brief(registration.mean_beltrami()) + " on average");
    parts.push_back(brief(registration.max_beltrami()) + " at most");
  }
  if (registration.reference_is_sphere()) parts.emplace_back("onto the reference's own sphere");
  std::string text = joinedLine("registration", parts);
  if (!registration.has_field()) return text;
  return text +
         joinedLine(
             registration.field() == v1::RegistrationResult::GIVEN ? "fields" : "area change",
             {"correlation " + brief(registration.correlation_before()) + " before and " +
                  brief(registration.correlation_after()) + " after",
              "difference " + brief(registration.mean_absolute_difference()) + " on average"});
}

std::string matchQualityLines(const v1::MatchCertificate& certificate) {
  std::vector<std::string> bent, met;
  if (certificate.has_flipped_faces()) {
    bent.push_back(counted(certificate.flipped_faces(), "flipped face", "flipped faces"));
  }
  if (certificate.has_mean_dilatation()) {
    bent.push_back("dilatation " + brief(certificate.mean_dilatation()) + " on average");
  }
  if (certificate.has_dilatation_95()) {
    bent.push_back(brief(certificate.dilatation_95()) + " or less on 95 % of the area");
  }
  if (certificate.has_area_distortion()) {
    bent.push_back("areas change by e^" + brief(certificate.area_distortion()));
  }
  if (certificate.has_cycle_error()) {
    met.push_back("points come back to " + brief(certificate.cycle_error()) + " on average");
  }
  if (certificate.has_landmark_error()) {
    met.push_back("landmarks are met up to " + brief(certificate.landmark_error()));
  }
  if (certificate.has_soft_landmark_error()) {
    met.push_back("soft landmarks are missed by up to " + brief(certificate.soft_landmark_error()));
  }
  if (certificate.has_teichmuller_distance()) {
    met.push_back("Teichmüller distance " + brief(certificate.teichmuller_distance()));
  }
  if (certificate.has_defect()) {
    met.push_back("defect of the modes " + brief(certificate.defect()));
  }
  return joinedLine("quality", bent) + joinedLine("agreement", met);
}

std::string timeLine(const google::protobuf::Map<std::string, double>& timing) {
  double seconds = 0;
  for (const auto& [stage, time] : timing) seconds += time;
  return seconds > 0 ? line("time", brief(seconds) + " s") : "";
}

// The sum, then the stages that matter, the longest first.
std::string stageLines(const google::protobuf::Map<std::string, double>& timing) {
  std::vector<std::pair<double, std::string>> stages;
  for (const auto& [stage, time] : timing) stages.emplace_back(-time, safe(stage));
  std::sort(stages.begin(), stages.end());
  std::vector<std::string> parts;
  for (const auto& [time, stage] : stages) {
    if (time <= stages.front().first / 50) parts.push_back(stage + " " + brief(-time) + " s");
  }
  return timeLine(timing) + joinedLine("", parts);
}

}  // namespace

std::string inspectionReport(const std::string& title, const v1::Inspection& inspection) {
  std::string text = safe(title) + ": " + (inspection.valid() ? "valid" : "not valid") + "\n" +
                     topologyLines(inspection.topology());
  for (const v1::Defect& defect : inspection.defects()) {
    text += line(defect.severity() == v1::Defect::BLOCKING ? "defect" : "warning",
                 v1::Defect::Kind_Name(defect.kind()) + ": " + safe(defect.message()));
    if (defect.elements_size() > 0) {
      text += line("", "elements " + firstElements(defect));
    }
  }
  for (const v1::RepairAction& action : inspection.repair()) {
    text += line("--repair",
                 "would " + safe(action.action()) + " (" + std::to_string(action.count()) + ")");
  }
  return text;
}

std::string signatureReport(const std::string& title, const v1::Signature& signature) {
  std::string text = title.empty() ? "" : safe(title) + "\n";
  text += topologyLines(signature.topology());
  if (signature.has_conformal()) text += conformalLines(signature.conformal());
  if (signature.metric().laplace_spectrum_size() > 0) {
    text += line("modes", spectrumText(signature.metric().laplace_spectrum()));
  }
  if (signature.metric().conformal_factor_spectrum_size() > 0) {
    text += line("factor", spectrumText(signature.metric().conformal_factor_spectrum()));
  }
  if (signature.shape().mean_curvature_spectrum_size() > 0) {
    text += line("curvature", spectrumText(signature.shape().mean_curvature_spectrum()));
    text += line("cross", spectrumText(signature.shape().cross_spectrum()));
  }
  text += certificateLines(signature.certificate());
  return text + timeLine(signature.timing());
}

std::string parameterizationReport(const std::string& title, const v1::Parameterization& result) {
  const v1::ParameterizationCertificate& certificate = result.certificate();
  return safe(title) + "\n" +
         line("target", v1::ParameterizationOptions::Target_Name(result.target())) +
         domainLines(result) + metricLine(certificate) +
         (result.has_registration() ? registrationLines(result.registration()) : "") +
         mapQualityLine(certificate) + layoutLines(result) + warningLines(certificate.warnings()) +
         stageLines(result.timing());
}

std::string matchReport(const std::string& title, const v1::SurfaceMatch& result) {
  std::string text = safe(title) + "\n" + line("distance", brief(result.distance())) +
                     line("method", v1::SurfaceMatch::Method_Name(result.method())) +
                     matchQualityLines(result.certificate());
  constexpr int kShown = 3;
  std::vector<std::string> others;
  for (const v1::SurfaceMatch::Alternative& other : result.alternatives()) {
    if (others.size() == kShown) {
      others.push_back(std::to_string(result.alternatives_size() - kShown) + " more");
      break;
    }
    others.push_back(v1::SurfaceMatch::Method_Name(other.method()) + " with defect " +
                     brief(other.defect()));
  }
  return text + joinedLine("others", others) + warningLines(result.certificate().warnings()) +
         timeLine(result.timing());
}

std::string distancesReport(const v1::SignatureDistances& distances) {
  const auto number = [](bool has, double value) {
    return has ? brief(value) : std::string("not defined");
  };
  return line("conformal", number(distances.has_conformal(), distances.conformal())) +
         line("metric", number(distances.has_metric(), distances.metric())) +
         line("shape", number(distances.has_shape(), distances.shape()));
}

std::string shapeReport(const v1::Shape& shape) {
  std::string text = safe(idOf(shape.name())) + "\n";
  if (!shape.label().empty()) text += line("label", safe(shape.label()));
  for (const auto& [key, value] : shape.tags()) {
    text += line("tag", safe(key) + " = " + safe(value));
  }
  text +=
      line("file", safe(shape.file_name()) + ", " + v1::MeshSource::Format_Name(shape.format()) +
                       ", " + brief(shape.mesh_bytes()) + " bytes");
  text += line("digest", safe(shape.digest()));
  return text + signatureReport("", shape.signature());
}

}  // namespace moduli::cli
