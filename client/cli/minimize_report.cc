#include "client/cli/minimize_report.h"

#include <cctype>
#include <vector>

#include "client/cli/output.h"
#include "client/cli/report_lines.h"
#include "core/base/text.h"

namespace moduli::cli {
namespace {

/// Steps shown of a long search.
constexpr std::size_t kFirst = 4, kLast = 6;
constexpr int kEntries = 6;

std::string spelled(std::string name, char blank) {
  for (char& c : name) c = c == '_' ? blank : static_cast<char>(std::tolower(c));
  return name;
}

std::string entriesText(const google::protobuf::RepeatedField<double>& entries) {
  std::string text;
  for (int i = 0; i < entries.size() && i < kEntries; ++i) {
    text += (i == 0 ? "" : "  ") + brief(entries[i]);
  }
  return entries.size() > kEntries ? text + "  ... (" + std::to_string(entries.size()) + ")" : text;
}

template <typename Message>
std::string remarks(const Message& message) {
  std::string text;
  for (const std::string& warning : message.warnings()) text += line("warning", safe(warning));
  double seconds = 0;
  for (const auto& [stage, time] : message.timing()) seconds += time;
  return seconds > 0 ? text + line("time", brief(seconds) + " s") : text;
}

std::vector<std::string> row(const MinimizedStep& step) {
  return {std::to_string(step.iteration), brief(step.value), brief(step.gradient_norm),
          brief(step.step), std::to_string(step.evaluations)};
}

std::string stepTable(const std::vector<MinimizedStep>& trace) {
  if (trace.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    if (trace.size() > kFirst + kLast + 1 && i == kFirst) {
      rows.push_back({"...", "", "", "", ""});
      i = trace.size() - kLast;
    }
    rows.push_back(row(trace[i]));
  }
  return "\n" + alignedTable({"iteration", "value", "gradient", "step", "evaluations"}, rows);
}

}  // namespace

std::string methodWord(v1::MinimizeOptions::Method method) {
  return spelled(v1::MinimizeOptions::Method_Name(method), '-');
}

std::string reasonWords(v1::Minimization::Reason reason) {
  return spelled(v1::Minimization::Reason_Name(reason), ' ');
}

std::string minimizationReport(const std::string& title, const MinimizedFunction& function) {
  const v1::Minimization& result = function.result;
  return safe(title) + "\n" + line("method", methodWord(result.method())) +
         line("converged", result.converged() ? "yes" : "no: " + reasonWords(result.reason())) +
         line("value", brief(result.value())) + line("gradient", brief(result.gradient_norm())) +
         line("work", counted(result.iterations(), "iteration", "iterations") + ", " +
                          counted(result.evaluations(), "evaluation", "evaluations") + ", " +
                          counted(result.factorizations(), "factorization", "factorizations")) +
         line("x", entriesText(result.x())) + remarks(result) + stepTable(function.trace);
}

std::string directionReport(const std::string& title, const v1::AffineDirection& direction) {
  return safe(title) + "\n" + line("direction", entriesText(direction.direction())) +
         line("decrease", brief(direction.decrease())) +
         line("convex", direction.convex() ? "yes" : "no") + remarks(direction);
}

std::string traceText(const std::vector<MinimizedStep>& trace) {
  std::string text = "iteration,value,gradient_norm,step,decrease,evaluations,factorizations\n";
  for (const MinimizedStep& step : trace) {
    text += std::to_string(step.iteration);
    for (const double number : {step.value, step.gradient_norm, step.step, step.decrease}) {
      text += "," + shortestDouble(number);
    }
    text +=
        "," + std::to_string(step.evaluations) + "," + std::to_string(step.factorizations) + "\n";
  }
  return text;
}

}  // namespace moduli::cli
