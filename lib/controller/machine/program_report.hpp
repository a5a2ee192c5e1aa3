#pragma once

#include <memory>
#include <string>
#include <vector>

#include <busbar/controller/published_program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

#include "core/json_writer.hpp"

namespace busbar::controller::detail {

/// Tells of a program what is published of it within limits, what not, and what is left out, each
/// with its reason.
class BUSBAR_API ProgramReport {
public:
    /// `name` is that of the file; `program` may be the problem for which all of it is refused.
    ProgramReport(std::string name, Configured<std::shared_ptr<const CheckedProgram>> program,
                  const PublishingLimits& limits);

    /// True if all of it is understood and everything that is to be published is.
    [[nodiscard]] bool is_good() const;
    /// Returns the report as lines for a person, with printable characters only.
    [[nodiscard]] std::vector<std::string> lines() const;
    /// Adds the report as an object.
    void write(busbar::detail::JsonWriter& json) const;

private:
    /// Lists what is left out and is not listed as a variable that is not published.
    [[nodiscard]] std::vector<std::string> left_out() const;
    /// Returns the limit that keeps variables out; empty if none does.
    [[nodiscard]] std::string exceeded() const;
    void write_variables(busbar::detail::JsonWriter& json) const;

    std::string name_;
    PublishingLimits limits_;
    /// Empty unless all of it is refused.
    std::string refusal_{};
    std::unique_ptr<PublishedProgram> program_{};
};

} // namespace busbar::controller::detail
