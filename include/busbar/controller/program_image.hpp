#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <busbar/controller/program_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/process_image.hpp>

namespace busbar::controller {

/// The variables of a program that are published, in a process image: each as seed 000, 6-2-2 has
/// it, with the value that it begins with.
///
/// A variable begins as declared; what is not declared begins as its type says, and where that says
/// nothing as 0, the first name of an enumeration, the lower end of a subrange without 0, or an
/// empty text. A structure's members in the image are those of its DerivedType, in their order.
///
/// Movable. create() may run in any thread; for the rest see ProcessImage.
class BUSBAR_API ProgramImage {
public:
    /// The "Default Binary" encoding of the DataType that a structure is published as.
    using EncodingOf = FunctionRef<NodeId(const DerivedType& structure)>;

    /// `variables` are indices into the program's variables, in the order in which they get their
    /// handles: 0, 1, 2... `types` and its program are not needed afterwards. The Problem is that
    /// of the first variable that an image cannot have, as a union, or whose initial value does not
    /// fit it; `where` is as ProgramTypes::create has it, with the members and elements behind.
    [[nodiscard]] static Configured<ProgramImage> create(const ProgramTypes& types,
                                                         std::span<const std::size_t> variables,
                                                         EncodingOf encoding_of,
                                                         const server::ImageOptions& options = {});

    [[nodiscard]] const std::shared_ptr<server::ProcessImage>& image() const { return image_; }
    /// By handle: the index among the program's variables.
    [[nodiscard]] std::span<const std::size_t> variables() const { return variables_; }

private:
    ProgramImage(std::shared_ptr<server::ProcessImage> image,
                 std::span<const std::size_t> variables)
        : image_{std::move(image)}, variables_(variables.begin(), variables.end())
    {
    }

    std::shared_ptr<server::ProcessImage> image_;
    std::vector<std::size_t> variables_;
};

} // namespace busbar::controller
