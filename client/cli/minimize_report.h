#pragma once

#include <string>

#include "client/cpp/minimized_function.h"

/// Minimizations as text.
namespace moduli::cli {

/// For people: the result, and its first and last steps. title: the function's name.
std::string minimizationReport(const std::string& title, const MinimizedFunction& function);
std::string directionReport(const std::string& title, const v1::AffineDirection& direction);

/// "affine-normal": what the command line calls a method.
std::string methodWord(v1::MinimizeOptions::Method method);
/// "max iterations".
std::string reasonWords(v1::Minimization::Reason reason);

/// CSV: the header iteration,value,gradient_norm,step,decrease,evaluations,factorizations and a row
/// for each step.
std::string traceText(const std::vector<MinimizedStep>& trace);

}  // namespace moduli::cli
