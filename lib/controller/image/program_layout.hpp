#pragma once

#include <memory>
#include <string>
#include <unordered_map>

#include <busbar/controller/program_image.hpp>
#include <busbar/server/image_layout.hpp>

namespace busbar::controller::detail {

/// Builds what an image needs for a program's variables. Makes each structure once.
class ProgramLayout {
public:
    ProgramLayout(const ProgramTypes& types, ProgramImage::EncodingOf encoding_of,
                  ElementaryTypes elementary)
        : types_{&types}, encoding_of_{encoding_of}, elementary_{elementary}
    {
    }

    /// The text of the Problem tells why the variable cannot be in an image.
    [[nodiscard]] Configured<server::ImageVariable> variable(const ResolvedType& type);

private:
    using Structure = std::shared_ptr<const server::ImageStructure>;

    [[nodiscard]] Configured<Structure> structure(const DerivedType& type);

    const ProgramTypes* types_;
    ProgramImage::EncodingOf encoding_of_;
    ElementaryTypes elementary_;
    std::unordered_map<const DerivedType*, Structure> structures_;
};

/// Names a variable as problems do: "variables[7] (Speed)", with line and column if they are known.
[[nodiscard]] std::string place_of_variable(const Program& program, std::size_t index);

} // namespace busbar::controller::detail
