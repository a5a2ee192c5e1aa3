#include "mapping_merge.hpp"

#include <algorithm>

namespace busbar::controller::detail {

namespace {

class Merge {
public:
    Merge(const model::SpaceReader& before, std::uint16_t index, const model::SpaceReader& after,
          Mapping imported, ModelReports& reports)
        : before_{before}, after_{after}, index_{index}, result_{std::move(imported)}, reports_{
                                                                                           reports}
    {
    }

    void keep(const NodeId& old_id, const DataMapping& mapping)
    {
        if (const auto id = kept(old_id, NodeClass::Variable)) {
            result_.variables.emplace(*id, mapping);
            compare(old_id, *id);
        }
    }
    void keep(const NodeId& old_id, const MethodMapping& mapping)
    {
        if (const auto id = kept(old_id, NodeClass::Method)) {
            result_.methods.emplace(*id, mapping);
        }
    }
    /// Drops the file's mapping of Methods that were nodes of another class before.
    void drop_changed()
    {
        for (auto each = result_.methods.begin(); each != result_.methods.end();) {
            const auto old_id = translate(each->first, after_, before_);
            const auto old_node = old_id ? before_.find(*old_id) : model::no_node;
            if (old_node != model::no_node && before_.node_class(old_node) != NodeClass::Method) {
                report(ModelCode::MappingDropped, each->first, "it was not a Method before");
                each = result_.methods.erase(each);
            } else {
                ++each;
            }
        }
    }
    [[nodiscard]] Mapping take() { return std::move(result_); }

private:
    /// Finds the node that keeps its mapping of this class, unless the file has one for it.
    [[nodiscard]] std::optional<NodeId> kept(const NodeId& old_id, NodeClass node_class)
    {
        auto id = translate(old_id, before_, after_);
        const auto node = id ? after_.find(*id) : model::no_node;
        if (node == model::no_node) {
            report(ModelCode::MappingDropped, old_id, "the node is gone");
            return std::nullopt;
        }
        if (after_.node_class(node) != node_class) {
            report(ModelCode::MappingDropped, *id, "the node is of another class");
            return std::nullopt;
        }
        const bool is_replaced = id->namespace_index() == index_ &&
                                 result_.variables.count(*id) + result_.methods.count(*id) != 0;
        return is_replaced ? std::nullopt : id;
    }
    void compare(const NodeId& old_id, const NodeId& new_id)
    {
        const auto old_node = before_.find(old_id);
        if (old_node == model::no_node || new_id.namespace_index() != index_) {
            return;
        }
        const auto was = before_.variable(old_node);
        const auto is = after_.variable(after_.find(new_id));
        const auto old_type = translate(before_.data_type_id(old_node), before_, after_);
        if (old_type != after_.data_type_id(after_.find(new_id)) ||
            was.value_rank != is.value_rank ||
            !std::equal(was.array_dimensions.begin(), was.array_dimensions.end(),
                        is.array_dimensions.begin(), is.array_dimensions.end())) {
            report(ModelCode::AttributesChanged, new_id, {});
        }
    }
    void report(ModelCode code, const NodeId& id, std::string found)
    {
        reports_.add({code, id, to_string(id), std::move(found)});
    }

    const model::SpaceReader& before_;
    const model::SpaceReader& after_;
    std::uint16_t index_;
    Mapping result_;
    ModelReports& reports_;
};

template <typename Map>
std::vector<const typename Map::value_type*> ordered(const Map& map)
{
    std::vector<const typename Map::value_type*> entries;
    for (const auto& each : map) {
        entries.push_back(&each);
    }
    std::sort(entries.begin(), entries.end(),
              [](const auto* a, const auto* b) { return a->first < b->first; });
    return entries;
}

} // namespace

std::optional<NodeId> translate(const NodeId& id, const model::SpaceReader& from,
                                const model::SpaceReader& to)
{
    if (id.namespace_index() >= from.namespace_count()) {
        return std::nullopt;
    }
    const auto index = to.namespace_index(from.namespace_uri(id.namespace_index()));
    if (!index) {
        return std::nullopt;
    }
    NodeId result = id;
    result.set_namespace_index(*index);
    return result;
}

Mapping translate(const Mapping& mapping, const model::SpaceReader& from,
                  const model::SpaceReader& to)
{
    Mapping result;
    const auto copy = [&](const auto& source, auto& target) {
        for (const auto& [id, each] : source) {
            const auto there = translate(id, from, to);
            if (there && to.find(*there) != model::no_node) {
                target.emplace(*there, each);
            }
        }
    };
    copy(mapping.variables, result.variables);
    copy(mapping.methods, result.methods);
    return result;
}

Mapping merge(const Mapping& mapping, const model::SpaceReader& before, Mapping imported,
              std::uint16_t index, const model::SpaceReader& after, ModelReports& reports)
{
    Merge merge{before, index, after, std::move(imported), reports};
    merge.drop_changed();
    for (const auto* each : ordered(mapping.variables)) {
        merge.keep(each->first, each->second);
    }
    for (const auto* each : ordered(mapping.methods)) {
        merge.keep(each->first, each->second);
    }
    return merge.take();
}

} // namespace busbar::controller::detail
