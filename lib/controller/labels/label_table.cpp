#include "label_table.hpp"

#include <algorithm>

#include "label_finder.hpp"

namespace busbar::controller::detail {

namespace {

// An address is the generation followed by the index of a leaf.
constexpr unsigned index_bits = 32;

} // namespace

backend::ResolvedLabel LabelTable::resolve(std::string_view name)
{
    const FoundLabel found = find_label(*program_, name);
    if (found.error != backend::LabelError::None) {
        return {.error = found.error};
    }
    const auto [entry, is_new] =
        by_memory_.emplace(found.at, static_cast<std::uint32_t>(leaves_.size()));
    if (is_new) {
        leaves_.push_back({found.at, found.kind, found.is_unsampled});
    }
    return {.error = backend::LabelError::None,
            .kind = found.kind,
            .address = (generation_ << index_bits) | entry->second,
            .is_unsampled_device = found.is_unsampled};
}

const LabelTable::Leaf* LabelTable::find(std::uint64_t address) const
{
    const auto index = static_cast<std::uint32_t>(address);
    const bool is_of_this = address >> index_bits == (generation_ << index_bits) >> index_bits;
    return is_of_this && index < leaves_.size() ? &leaves_[index] : nullptr;
}

std::optional<std::vector<LabelStep>> LabelTable::steps(std::span<const backend::LabelPlace> places,
                                                        std::size_t bytes) const
{
    std::vector<LabelStep> steps;
    steps.reserve(places.size());
    for (const backend::LabelPlace& place : places) {
        const Leaf* const leaf = find(place.address);
        if (leaf == nullptr || place.size != size_of(leaf->kind) || place.size > bytes ||
            place.offset > bytes - place.size) {
            return std::nullopt;
        }
        steps.push_back({leaf->memory, leaf->kind, place.offset,
                         static_cast<std::uint32_t>(words_of(leaf->kind))});
    }
    return steps;
}

bool LabelTable::has_unsampled(std::span<const backend::LabelPlace> places) const
{
    return std::ranges::any_of(places, [this](const backend::LabelPlace& place) {
        return find(place.address)->is_unsampled;
    });
}

} // namespace busbar::controller::detail
