#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>

#include "label_sampler.hpp"

namespace busbar::controller::detail {

/// The addresses given to labels of one program. Addresses of another generation, and those that
/// were never given, are not valid. Used by the server's thread.
class LabelTable {
public:
    LabelTable(std::shared_ptr<LabelProgram> program, std::uint64_t generation)
        : program_{std::move(program)}, generation_{generation}
    {
    }

    [[nodiscard]] std::uint64_t generation() const { return generation_; }
    [[nodiscard]] backend::ResolvedLabel resolve(std::string_view name);
    /// Finds the memory of the places. Nothing if one of them has an unknown address, a size that
    /// differs from its label's, or exceeds `bytes`.
    [[nodiscard]] std::optional<std::vector<LabelStep>>
    steps(std::span<const backend::LabelPlace> places, std::size_t bytes) const;
    /// Tells whether one of the places, all of which must have steps, cannot be sampled.
    [[nodiscard]] bool has_unsampled(std::span<const backend::LabelPlace> places) const;

private:
    struct Leaf {
        std::byte* memory;
        backend::LabelKind kind;
        bool is_unsampled;
    };

    [[nodiscard]] const Leaf* find(std::uint64_t address) const;

    std::shared_ptr<LabelProgram> program_;
    std::uint64_t generation_;
    /// Contains each value once, however often it is resolved.
    std::vector<Leaf> leaves_{};
    std::unordered_map<const std::byte*, std::uint32_t> by_memory_{};
};

} // namespace busbar::controller::detail
