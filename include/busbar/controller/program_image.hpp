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

/// The options of a ProgramImage.
struct ProgramImageOptions {
    server::ImageOptions image{};
    /// The elementary types of the nodes, see MachineTypes::elementary_in.
    ElementaryTypes elementary{ElementaryTypes::BuiltIn};
    /// Returns the memory of a variable in the runtime, like ImageVariable::runtime; empty: the
    /// variable is in the image, like all variables without this function. A variable in the
    /// runtime starts with its present value.
    std::function<std::span<std::byte>(const GlobalVariable& variable)> runtime_of{};
};

/// Variables that were added to a ProgramImage together.
struct ProgramImageAddition {
    /// Their handles start with this one and are consecutive.
    std::uint32_t first_handle{0};
    /// For each handle from there on, the index among the variables of the program that they belong
    /// to.
    std::vector<std::size_t> variables{};
    /// The memory that the task works in, with handles from 0; lives as long as the image. Null if
    /// there are none.
    server::ImageMemory* memory{nullptr};
};

/// The published variables of a program in a process image: each as in the
/// W588, 6-2-2, with its initial value.
///
/// A variable starts with the declared value, otherwise with that of its type, otherwise with 0,
/// the first name of an enumeration, the lower end of a subrange without 0, or an empty text. A
/// structure's members in the image are those of its DerivedType, in their order.
///
/// Clients can write all of them except CONSTANT ones.
///
/// Movable. create() may run in any thread, add() in one at a time other than the task's; for the
/// rest see ProcessImage.
class BUSBAR_API ProgramImage {
public:
    /// The "Default Binary" encoding of the DataType that a structure is published as.
    using EncodingOf = FunctionRef<NodeId(const DerivedType& structure)>;

    /// `variables` are indices into the program's variables, in the order of their handles: 0, 1,
    /// 2... `types` and its program are not needed afterwards. The Problem is that of the first
    /// variable that an image cannot hold, such as a union, or that cannot be at its place in the
    /// runtime, otherwise that of check_initial_values(); `where` is as in ProgramTypes::create,
    /// followed by the members and elements.
    [[nodiscard]] static Configured<ProgramImage> create(const ProgramTypes& types,
                                                         std::span<const std::size_t> variables,
                                                         EncodingOf encoding_of,
                                                         const ProgramImageOptions& options = {});

    /// Adds variables while the task runs (W588, 4-2-5: online edit), like
    /// create(): indices into the variables of `types`' program, which may be another one and is
    /// not needed afterwards. No scan waits for it; each has all of them or none, starting with the
    /// task's next publish(). An empty list has no effect.
    ///
    /// Problems are those of create(); in addition, with an empty `where`, Bad_TooManyOperations
    /// after ImageOptions::max_additions, Bad_OutOfMemory if the image would become too large, and
    /// Bad_OutOfRange for a variable of more than max_bytes_per_scan bytes. Nothing has been added
    /// then.
    [[nodiscard]] Configured<ProgramImageAddition>
    add(const ProgramTypes& types, std::span<const std::size_t> variables, EncodingOf encoding_of);

    [[nodiscard]] const std::shared_ptr<server::ProcessImage>& image() const { return image_; }
    /// Returns, for each handle, the index among the program's variables; only of those at
    /// creation.
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
