#pragma once

#include <string>
#include <vector>

#include "moduli/v1/catalog.pb.h"
#include "moduli/v1/matching.pb.h"
#include "moduli/v1/mesh.pb.h"
#include "moduli/v1/parameterization.pb.h"
#include "moduli/v1/signature.pb.h"

/// Results as text for people.
namespace moduli::cli {

/// title: the mesh's name.
std::string inspectionReport(const std::string& title, const v1::Inspection& inspection);
std::string signatureReport(const std::string& title, const v1::Signature& signature);
std::string parameterizationReport(const std::string& title, const v1::Parameterization& result);
std::string matchReport(const std::string& title, const v1::SurfaceMatch& result);
std::string distancesReport(const v1::SignatureDistances& distances);
std::string shapeReport(const v1::Shape& shape);
std::string searchReport(const v1::SearchResult& result);
/// One after the other, each below the name of its query.
std::string batchReport(const std::vector<v1::QueryResult>& results);
/// confusion: with a row for each label, of those that came first for it.
std::string evaluationReport(const std::string& title, const v1::Evaluation& evaluation,
                             bool confusion);
std::string duplicatesReport(const std::string& title, const v1::Duplicates& duplicates);

}  // namespace moduli::cli
