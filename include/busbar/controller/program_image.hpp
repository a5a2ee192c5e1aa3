#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <busbar/controller/program_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/process_image.hpp>

namespace busbar::controller {

struct ProgramImageOptions {
    server::ImageOptions image{};
    /// As the nodes have it, which MachineTypes::elementary_in tells.
    ElementaryTypes elementary{ElementaryTypes::BuiltIn};
    /// Where the runtime has a variable, as ImageVariable::runtime says; nothing: the variable lies
    /// in the image, as all do without this. What the runtime has begins as it is there.
    std::function<std::span<std::byte>(const GlobalVariable& variable)> runtime_of{};
};

/// Variables that were added to a ProgramImage together.
struct ProgramImageAddition {
    /// Theirs are this and the next ones.
    std::uint32_t first_handle{0};
    /// By handle from there: the index among the variables of the program that they are of.
    std::vector<std::size_t> variables{};
    /// What the task works in, with handles from 0; lives as long as the image. Null if there are
    /// none.
    server::ImageMemory* memory{nullptr};
};

/// The variables of a program that are published, in a process image: each as seed 000, 6-2-2 has
/// it, with the value that it begins with.
///
/// A variable begins as declared; what is not declared begins as its type says, and where that says
/// nothing as 0, the first name of an enumeration, the lower end of a subrange without 0, or an
/// empty text. A structure's members in the image are those of its DerivedType, in their order.
///
/// Clients can write all of them but CONSTANT ones.
///
/// Movable. create() may run in any thread, add() in one at a time that is not the task's; for the
/// rest see ProcessImage.
class BUSBAR_API ProgramImage {
public:
    /// The "Default Binary" encoding of the DataType that a structure is published as.
    using EncodingOf = FunctionRef<NodeId(const DerivedType& structure)>;

    /// `variables` are indices into the program's variables, in the order in which they get their
    /// handles: 0, 1, 2... `types` and its program are not needed afterwards. The Problem is that
    /// of the first variable that an image cannot have, as a union, or whose initial value does not
    /// fit it, or that cannot lie where the runtime has it; `where` is as ProgramTypes::create has
    /// it, with the members and elements behind.
    [[nodiscard]] static Configured<ProgramImage> create(const ProgramTypes& types,
                                                         std::span<const std::size_t> variables,
                                                         EncodingOf encoding_of,
                                                         const ProgramImageOptions& options = {});

    /// Adds variables while the task runs (seed 000, 4-2-5: online edit), as create() has them:
    /// indices into the variables of `types`' program, which may be another one and is not needed
    /// afterwards. No scan waits for it; each has all of them or none, from the task's next
    /// publish() on. Adding none is no addition.
    ///
    /// Problems are those of create(); besides, with an empty `where`, Bad_TooManyOperations after
    /// ImageOptions::max_additions, Bad_OutOfMemory if the image would get too large, and
    /// Bad_OutOfRange for a variable of more bytes than max_bytes_per_scan. Nothing was added then.
    [[nodiscard]] Configured<ProgramImageAddition>
    add(const ProgramTypes& types, std::span<const std::size_t> variables, EncodingOf encoding_of);

    [[nodiscard]] const std::shared_ptr<server::ProcessImage>& image() const { return image_; }
    /// By handle: the index among the program's variables, of those that it was made with.
    [[nodiscard]] std::span<const std::size_t> variables() const { return variables_; }
    [[nodiscard]] ElementaryTypes elementary() const { return options_.elementary; }

private:
    ProgramImage(std::shared_ptr<server::ProcessImage> image,
                 std::span<const std::size_t> variables, ProgramImageOptions options)
        : image_{std::move(image)},
          variables_(variables.begin(), variables.end()), options_{std::move(options)}
    {
    }

    std::shared_ptr<server::ProcessImage> image_;
    std::vector<std::size_t> variables_;
    ProgramImageOptions options_;
};

} // namespace busbar::controller
