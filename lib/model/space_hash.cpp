#include "space_hash.hpp"

#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/binary/codec.hpp>

#include "namespace_map.hpp"

namespace busbar::model::detail {

namespace {

std::uint64_t mixed(std::uint64_t value)
{
    value ^= value >> 31U;
    value *= 0x9E37'79B9'7F4A'7C15U;
    return value ^ value >> 29U;
}

std::uint64_t hash_of(std::string_view text)
{
    return mixed(std::hash<std::string_view>{}(text));
}

std::uint64_t hash_of(std::span<const std::byte> bytes)
{
    return hash_of(std::string_view{reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Hashes values with namespace indices that depend on the URIs alone.
class SpaceHash {
public:
    explicit SpaceHash(const SpaceReader& space) : space_{space}, map_(space.namespace_count())
    {
        for (std::size_t i = 1; i < map_.size(); ++i) {
            const std::string_view uri = space.namespace_uri(static_cast<std::uint16_t>(i));
            map_[i] = static_cast<std::uint16_t>(hash_of(uri) | 1U);
        }
    }

    [[nodiscard]] std::uint64_t of(NodeIndex node)
    {
        // All attributes in a row are encoded and hashed faster than each of them.
        binary::VectorSink sink;
        binary::Writer writer{sink};
        for (std::uint32_t id = 1; id <= static_cast<std::uint32_t>(AttributeId::AccessLevelEx);
             ++id) {
            if (id == static_cast<std::uint32_t>(AttributeId::Value)) {
                continue;
            }
            if (auto attribute = space_.attribute(node, AttributeId{id})) {
                writer.number(id);
                encode(writer, mapped(std::move(*attribute)));
            }
        }
        const std::uint64_t hash = writer.ok() ? hash_of(sink.take(writer.written())) : 0;
        // A value may be too deep to be encoded.
        return mixed(of_id(node) + hash + 3 * of(space_.value(node))) ^ references(node) ^
               further_texts(node);
    }

private:
    [[nodiscard]] Variant mapped(Variant value) const
    {
        if (map_.size() > 1) {
            map_namespaces(value, map_);
        }
        return value;
    }
    [[nodiscard]] std::uint64_t of(Variant value) const
    {
        const auto bytes = binary::to_bytes(mapped(std::move(value)));
        return bytes ? hash_of(*bytes) : 0;
    }
    /// Each reference asks for it again.
    [[nodiscard]] std::uint64_t of_id(NodeIndex node)
    {
        const auto [known, is_new] = ids_.try_emplace(node, 0);
        if (is_new) {
            known->second = of(Variant{space_.node_id(node)});
        }
        return known->second;
    }
    [[nodiscard]] std::uint64_t further_texts(NodeIndex node) const
    {
        std::uint64_t sum = 0;
        if (space_.has_further_texts(node)) {
            for (const AttributeId id : {AttributeId::DisplayName, AttributeId::Description,
                                         AttributeId::InverseName, AttributeId::Value}) {
                for (const LocalizedText& text : space_.texts(node, id)) {
                    sum += mixed(of(Variant{text}) + static_cast<std::uint32_t>(id));
                }
            }
        }
        return sum;
    }
    [[nodiscard]] std::uint64_t references(NodeIndex node)
    {
        std::uint64_t sum = 0;
        ReferenceCursor cursor = space_.references(node);
        while (const auto reference = cursor.next()) {
            sum += mixed(mixed(of_id(reference->type)) + of_id(reference->target) * 3 +
                         (reference->is_forward ? 1 : 0));
        }
        return sum;
    }

    const SpaceReader& space_;
    std::vector<std::uint16_t> map_;
    std::unordered_map<NodeIndex, std::uint64_t> ids_;
};

} // namespace

std::uint64_t space_hash(const SpaceReader& space, std::optional<std::uint16_t> only)
{
    SpaceHash hash{space};
    std::uint64_t sum = only ? 0 : space.namespace_count();
    space.for_each([&](NodeIndex node) {
        if (!only || space.node_id(node).namespace_index() == *only) {
            sum += hash.of(node);
        }
    });
    return sum;
}

} // namespace busbar::model::detail
