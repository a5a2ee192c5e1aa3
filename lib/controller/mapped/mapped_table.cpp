#include "mapped_table.hpp"

#include <algorithm>
#include <utility>

namespace busbar::controller::detail {

namespace {

/// False if a leaf has a label although its type cannot have one (SH-082679, 8.2). Writing a
/// project with such a mapping is refused; in a project that is in use only that node fails.
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

LeafRange MappedTable::add_leaves(const ValueShape& shape, std::vector<std::string>& labels,
                                  std::uint32_t scaling)
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
        leaf.scaling = scaling;
        leaves_.push_back(leaf);
        names_.push_back(std::move(labels[i]));
        ++range.count;
    }
    return range;
}

/// Adds a leaf with one label, or with none.
LeafRange MappedTable::add_leaf(std::string label, MappedLeaf::Use use, LeafType type)
{
    LeafRange range;
    range.first = static_cast<std::uint32_t>(leaves_.size());
    if (!label.empty()) {
        MappedLeaf leaf;
        leaf.node = static_cast<std::uint32_t>(nodes_.size() - 1);
        leaf.use = use;
        leaf.type = type;
        leaves_.push_back(leaf);
        names_.push_back(std::move(label));
        range.count = 1;
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
        if (variable.scaling.is_set()) {
            scalings_.push_back(variable.scaling);
        }
        added.range = add_leaves(
            *variable.shape, variable.labels,
            variable.scaling.is_set() ? static_cast<std::uint32_t>(scalings_.size()) : 0);
        added.quality =
            add_leaf(std::move(variable.quality), MappedLeaf::Use::Raw, {BuiltInType::UInt32});
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
    added.handle =
        add_leaf(std::move(method.handle), MappedLeaf::Use::Handle, {BuiltInType::UInt16});
    added.done = add_leaf(std::move(method.done), MappedLeaf::Use::Raw, {BuiltInType::UInt32});
    for (MappedArgument& argument : method.arguments) {
        add_argument(argument, added.arguments);
    }
    for (MappedArgument& output : method.outputs) {
        add_argument(output, added.outputs);
        added.has_outputs = added.has_outputs || added.outputs.back().shape == nullptr;
    }
    methods_.push_back(std::move(added));
    return methods_.size() - 1;
}

void MappedTable::add_argument(MappedArgument& argument, std::vector<Argument>& to)
{
    Argument& one = to.emplace_back();
    if (argument.shape != nullptr && !can_have_labels(*argument.shape, argument.labels)) {
        argument.shape = nullptr;
    }
    if (argument.shape != nullptr) {
        one.range = add_leaves(*argument.shape, argument.labels);
    } else {
        // Count the labels although none is resolved: the Call is refused.
        one.range.count = std::any_of(argument.labels.begin(), argument.labels.end(),
                                      [](const std::string& label) { return !label.empty(); })
                              ? 1
                              : 0;
    }
    one.shape = std::move(argument.shape);
}

MappedTable::Variable* MappedTable::variable(std::uint64_t handle)
{
    return handle < variables_.size() ? &variables_[static_cast<std::size_t>(handle)] : nullptr;
}

MappedTable::Method* MappedTable::method(std::uint64_t handle)
{
    return handle < methods_.size() ? &methods_[static_cast<std::size_t>(handle)] : nullptr;
}

std::optional<LabelConversion> MappedTable::conversion_of(const MappedLeaf& leaf,
                                                          const backend::LabelKind& kind,
                                                          const ConversionOptions& options) const
{
    const bool is_bit = kind.type == backend::LabelType::Bit;
    switch (leaf.use) {
    case MappedLeaf::Use::Handle:
        return is_handle_label(kind.type) ? LabelConversion::of(leaf.type, kind, options)
                                          : std::nullopt;
    case MappedLeaf::Use::Raw:
        // The conversion is used for its size only: values of this leaf are not numbers with a
        // range.
        return is_quality_label(kind.type)
                   ? LabelConversion::of(is_bit ? LeafType{BuiltInType::Boolean} : leaf.type, kind,
                                         options)
                   : std::nullopt;
    case MappedLeaf::Use::Value:
        break;
    }
    if (leaf.scaling == 0) {
        return LabelConversion::of(leaf.type, kind, options);
    }
    const Scaling& scaling = scalings_[leaf.scaling - 1];
    const double factor = (scaling.high - scaling.low) / (scaling.raw_high - scaling.raw_low);
    return LabelConversion::scaled(leaf.type, kind, factor, scaling.low - factor * scaling.raw_low);
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
        leaf.conversion = conversion_of(leaf, label.kind, options);
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
        const bool has_value = measure(variable.range);
        variable.is_broken = !measure(variable.quality) || !has_value;
    }
    for (Method& method : methods_) {
        const bool has_handle = measure(method.handle);
        method.is_broken = !measure(method.done) || !has_handle;
        for (std::vector<Argument>* const list : {&method.arguments, &method.outputs}) {
            for (Argument& argument : *list) {
                if (argument.shape != nullptr) {
                    method.is_broken = !measure(argument.range) || method.is_broken;
                }
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

void MappedTable::add_places(const Variable& variable, backend::LabelRequest& request) const
{
    add_places(variable.range, request);
    add_places(variable.quality, request);
}

StatusCode MappedTable::quality_of(const Variable& variable, const std::byte* bytes) const
{
    if (variable.quality.count == 0) {
        return status::Good;
    }
    std::uint32_t code = 0;
    for (std::size_t i = variable.quality.bytes; i > 0; --i) {
        code = code << 8U | std::to_integer<std::uint32_t>(bytes[variable.range.bytes + i - 1]);
    }
    if (variable.quality.bytes < sizeof code) {
        return code == 0 ? status::Good : status::Bad_DeviceFailure;
    }
    // Keep severity and sub code; 11 is not a severity (Part 4, 7.39), the other bits belong to the
    // server.
    constexpr std::uint32_t both_bits = 0xC0000000U;
    constexpr std::uint32_t code_bits = 0xFFFF0000U;
    return (code & both_bits) == both_bits ? StatusCode{status::Bad_DeviceFailure}
                                           : StatusCode{code & code_bits};
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
