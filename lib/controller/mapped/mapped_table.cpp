#include "mapped_table.hpp"

#include <algorithm>
#include <utility>

namespace busbar::controller::detail {

namespace {

/// False if there is a label for a leaf of a type that no label can have (seed 001, 8.2). A project
/// with such a mapping is refused; one that is there costs its node alone.
bool can_have_labels(const ValueShape& shape, const std::vector<std::string>& labels)
{
    for (std::size_t i = 0; i < std::min(labels.size(), shape.leaf_count()); ++i) {
        if (!labels[i].empty() && words_of(shape.leaf_type(i)) == 0) {
            return false;
        }
    }
    return true;
}

} // namespace

LeafRange MappedTable::add_leaves(const ValueShape& shape, std::vector<std::string>& labels)
{
    LeafRange range;
    range.first = static_cast<std::uint32_t>(leaves_.size());
    const std::size_t count = std::min(labels.size(), shape.leaf_count());
    for (std::size_t i = 0; i < count; ++i) {
        if (labels[i].empty()) {
            continue;
        }
        MappedLeaf leaf;
        leaf.leaf = static_cast<std::uint32_t>(i);
        leaf.node = static_cast<std::uint32_t>(nodes_.size() - 1);
        leaf.type = shape.leaf_type(i);
        leaves_.push_back(leaf);
        names_.push_back(std::move(labels[i]));
        ++range.count;
    }
    return range;
}

std::uint64_t MappedTable::add(MappedVariable variable)
{
    nodes_.push_back(std::move(variable.node));
    Variable added;
    if (variable.shape != nullptr && !can_have_labels(*variable.shape, variable.labels)) {
        variable.shape = nullptr;
    }
    if (variable.shape != nullptr) {
        added.range = add_leaves(*variable.shape, variable.labels);
    }
    added.shape = std::move(variable.shape);
    added.is_readable = variable.is_readable;
    added.kept = std::move(variable.initial);
    variables_.push_back(std::move(added));
    return variables_.size() - 1;
}

std::uint64_t MappedTable::add(MappedMethod method)
{
    nodes_.push_back(std::move(method.node));
    Method added;
    added.has_outputs = method.has_outputs;
    added.handle.first = static_cast<std::uint32_t>(leaves_.size());
    if (!method.handle.empty()) {
        MappedLeaf leaf;
        leaf.node = static_cast<std::uint32_t>(nodes_.size() - 1);
        leaf.is_handle = true;
        leaf.type = {BuiltInType::UInt16};
        leaves_.push_back(leaf);
        names_.push_back(std::move(method.handle));
        added.handle.count = 1;
    }
    for (MappedArgument& argument : method.arguments) {
        Argument& one = added.arguments.emplace_back();
        if (argument.shape != nullptr && !can_have_labels(*argument.shape, argument.labels)) {
            argument.shape = nullptr;
        }
        if (argument.shape != nullptr) {
            one.range = add_leaves(*argument.shape, argument.labels);
        } else {
            // Counted, though nothing is resolved: the Call is refused.
            one.range.count = std::any_of(argument.labels.begin(), argument.labels.end(),
                                          [](const std::string& label) { return !label.empty(); })
                                  ? 1
                                  : 0;
        }
        one.shape = std::move(argument.shape);
    }
    methods_.push_back(std::move(added));
    return methods_.size() - 1;
}

MappedTable::Variable* MappedTable::variable(std::uint64_t handle)
{
    return handle < variables_.size() ? &variables_[static_cast<std::size_t>(handle)] : nullptr;
}

MappedTable::Method* MappedTable::method(std::uint64_t handle)
{
    return handle < methods_.size() ? &methods_[static_cast<std::size_t>(handle)] : nullptr;
}

bool MappedTable::resolve_one(MappedLeaf& leaf, const backend::ResolvedLabel& label,
                              const ConversionOptions& options, MappedObserver* observer)
{
    leaf.address = label.address;
    leaf.words = static_cast<std::uint32_t>(backend::words_of(label.kind));
    leaf.is_unsampled_device = label.is_unsampled_device;
    leaf.conversion.reset();
    MappedErrorCode code = MappedErrorCode::Unavailable;
    if (label.error == backend::LabelError::None) {
        const bool fits = !leaf.is_handle || is_handle_label(label.kind.type);
        leaf.conversion = fits ? LabelConversion::of(leaf.type, label.kind, options) : std::nullopt;
        if (leaf.conversion) {
            return true;
        }
        code = MappedErrorCode::WrongType;
    }
    if (observer != nullptr) {
        observer->error({code, name_of(leaf), &node_of(leaf)});
    }
    return false;
}

bool MappedTable::resolve(std::span<const backend::ResolvedLabel> labels,
                          const MappedOptions& options, MappedObserver* observer)
{
    bool is_well = labels.size() == leaves_.size();
    for (std::size_t i = 0; i < std::min(labels.size(), leaves_.size()); ++i) {
        const bool is_usable = resolve_one(leaves_[i], labels[i], options.conversion, observer);
        is_well = (is_usable || options.isolates_failures) && is_well;
    }
    if (is_well) {
        measure_all();
    }
    return is_well;
}

bool MappedTable::measure(LeafRange& range) const
{
    range.bytes = 0;
    range.words = 0;
    const auto all = leaves().subspan(range.first, range.count);
    if (!std::all_of(all.begin(), all.end(),
                     [](const MappedLeaf& leaf) { return leaf.conversion.has_value(); })) {
        return false;
    }
    for (const MappedLeaf& leaf : all) {
        range.bytes += leaf.conversion->label_size();
        range.words += leaf.words;
    }
    return true;
}

void MappedTable::measure_all()
{
    for (Variable& variable : variables_) {
        variable.is_broken = !measure(variable.range);
    }
    for (Method& method : methods_) {
        method.is_broken = !measure(method.handle);
        for (Argument& argument : method.arguments) {
            if (argument.shape != nullptr) {
                method.is_broken = !measure(argument.range) || method.is_broken;
            }
        }
    }
}

void MappedTable::add_places(const LeafRange& range, backend::LabelRequest& request) const
{
    auto offset = static_cast<std::uint32_t>(request.bytes.size());
    for (const MappedLeaf& leaf : leaves().subspan(range.first, range.count)) {
        const auto size = static_cast<std::uint32_t>(leaf.conversion->label_size());
        request.places.push_back({leaf.address, offset, size});
        offset += size;
    }
    request.bytes.resize(offset);
}

Result<Variant> MappedTable::decode(const ValueShape& shape, const LeafRange& range,
                                    const std::byte* bytes, const Variant* previous,
                                    const MappedLeaf** culprit) const
{
    const MappedLeaf* next = leaves_.data() + range.first;
    const MappedLeaf* const end = next + range.count;
    return shape.assemble(previous, [&](std::size_t leaf, void* value) -> StatusCode {
        if (next == end || next->leaf != leaf) {
            return status::Good;
        }
        const StatusCode read = next->conversion->read(bytes, value);
        if (read.is_bad()) {
            *culprit = next;
        }
        bytes += next->conversion->label_size();
        ++next;
        return read;
    });
}

StatusCode MappedTable::encode(const ValueShape& shape, const LeafRange& range,
                               const Variant& value, std::byte* bytes) const
{
    const MappedLeaf* next = leaves_.data() + range.first;
    const MappedLeaf* const end = next + range.count;
    return shape.take_apart(value, [&](std::size_t leaf, const void* part) -> StatusCode {
        if (next == end || next->leaf != leaf) {
            return status::Good;
        }
        const StatusCode written = next->conversion->write(part, bytes);
        bytes += next->conversion->label_size();
        ++next;
        return written;
    });
}

} // namespace busbar::controller::detail
