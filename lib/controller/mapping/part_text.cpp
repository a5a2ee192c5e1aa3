#include "part_text.hpp"

#include <algorithm>

#include "core/number_text.hpp"

namespace busbar::controller::detail {

namespace {

using Kind = MappedPart::Kind;

constexpr std::size_t max_dimensions = 3;

/// Takes "[12]" from the front.
bool take_element(std::string_view& text, std::uint32_t max_elements, PartStep& to)
{
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) {
        return false;
    }
    const char* const last = text.data() + end;
    const auto [stop, error] = busbar::detail::read_number(text.data() + 1, last, to.number);
    if (error != std::errc{} || stop != last || to.number >= max_elements) {
        return false;
    }
    text.remove_prefix(end + 1);
    return true;
}

/// Takes ".Name" from the front, up to the next period or bracket without a backslash.
bool take_field(std::string_view& text, PartStep& to)
{
    text.remove_prefix(1);
    while (!text.empty() && text.front() != '.' && text.front() != '[' && text.front() != ']') {
        if (text.front() == '\\') {
            text.remove_prefix(1);
            if (text.empty()) {
                return false;
            }
        }
        to.name += text.front();
        text.remove_prefix(1);
    }
    to.kind = Kind::Field;
    return !to.name.empty();
}

} // namespace

std::optional<std::vector<PartStep>> read_part_path(std::string_view text, std::size_t max_levels,
                                                    std::uint32_t max_elements)
{
    std::vector<PartStep> steps;
    while (!text.empty()) {
        PartStep step;
        const bool is_read = text.front() == '[' ? take_element(text, max_elements, step)
                                                 : text.front() == '.' && take_field(text, step);
        if (!is_read || steps.size() == max_levels) {
            return std::nullopt;
        }
        steps.push_back(std::move(step));
    }
    return steps;
}

PartTree* PartTree::child(const PartStep& step)
{
    if (!children_.empty() && children_.front()->part_.kind != step.kind) {
        return nullptr;
    }
    const std::string key =
        step.kind == Kind::Element ? std::to_string(step.number) : '.' + step.name;
    PartTree*& found = by_key_[key];
    if (found == nullptr) {
        MappedPart part{.kind = step.kind, .number = step.number, .name = step.name};
        children_.push_back(std::make_unique<PartTree>(std::move(part)));
        found = children_.back().get();
    }
    return found;
}

MappedPart* PartTree::at(const std::vector<PartStep>& steps)
{
    PartTree* here = this;
    // The node to mark as an array or structure: the value or field that contains the elements.
    PartTree* owner = this;
    std::size_t dimension = 0;
    for (const PartStep& step : steps) {
        const bool is_element = step.kind == Kind::Element;
        dimension = is_element ? dimension + 1 : 0;
        PartTree* const next = dimension > max_dimensions ? nullptr : here->child(step);
        if (next == nullptr) {
            return nullptr;
        }
        (is_element ? owner->part_.is_array : owner->part_.is_structure) = true;
        here = next;
        owner = is_element ? owner : next;
    }
    return &here->part_;
}

MappedPart PartTree::take()
{
    MappedPart whole = std::move(part_);
    whole.parts.reserve(children_.size());
    for (const auto& child : children_) {
        whole.parts.push_back(child->take());
    }
    std::stable_sort(whole.parts.begin(), whole.parts.end(),
                     [](const auto& a, const auto& b) { return a.number < b.number; });
    return whole;
}

} // namespace busbar::controller::detail
