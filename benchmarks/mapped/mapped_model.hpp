#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/controller/project.hpp>

namespace busbar::bench {

/// An information model as the manual measures them (SH-082679, Appendix 7): Objects below the
/// Objects folder, and Int16 Variables below each, of which each is one label.
struct MappedModel {
    std::size_t objects{250};   // of all files together
    std::size_t variables{100}; // of each Object
    /// Further Objects below each Object, which have nothing.
    std::size_t fillers{0};
    std::size_t files{1};
    bool is_mapped{true};

    [[nodiscard]] std::size_t variable_count() const { return objects * variables; }
    [[nodiscard]] std::size_t node_count() const
    {
        return objects * (1 + fillers) + variable_count();
    }
};

/// Of a Variable the label, and the text of its NodeId: "M7" of number 14, "S7" of number 15. What
/// the M are moves with each scan of a program, what the S are stands still: half of any few.
[[nodiscard]] std::string mapped_name(std::size_t number);

/// The files, each with a namespace of its own, for which the Objects must suffice.
[[nodiscard]] std::vector<controller::ProjectModel> model_files(const MappedModel& model);

} // namespace busbar::bench
