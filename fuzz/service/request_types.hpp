#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>

namespace busbar::fuzz {

/// The requests of namespace 0 and their responses, by the ids of their binary encodings.
class RequestTypes {
public:
    struct Entry {
        const binary::DynamicType* request{nullptr};
        const binary::DynamicType* response{nullptr};
    };

    [[nodiscard]] static const RequestTypes& all()
    {
        static const RequestTypes types;
        return types;
    }

    /// Null if there is none of that encoding.
    [[nodiscard]] const Entry* find(std::uint32_t encoding) const
    {
        const auto found = entries_.find(encoding);
        return found == entries_.end() ? nullptr : &found->second;
    }
    [[nodiscard]] std::span<const std::uint32_t> encodings() const { return encodings_; }
    [[nodiscard]] const binary::DynamicTypes& types() const { return types_; }

private:
    RequestTypes()
    {
        std::vector<binary::DataTypeEntry> entries = binary::namespace0_data_types();
        std::map<std::string, NodeId> ids;
        for (const binary::DataTypeEntry& entry : entries) {
            ids.emplace(entry.name.view(), entry.id);
        }
        types_ = binary::DynamicTypes::compile(std::move(entries));
        for (const auto& [name, id] : ids) {
            add(name, id, ids);
        }
    }
    void add(const std::string& name, const NodeId& id, const std::map<std::string, NodeId>& ids)
    {
        static const std::string ending = "Request";
        const auto* const type = name.ends_with(ending) ? types_.find(id) : nullptr;
        if (type == nullptr || type->encoding_id.is_null() || type->fields.empty() ||
            type->fields.front().name != "RequestHeader") {
            return;
        }
        const auto other = ids.find(name.substr(0, name.size() - ending.size()) + "Response");
        if (other != ids.end()) {
            const std::uint32_t encoding = type->encoding_id.numeric();
            entries_.emplace(encoding, Entry{type, types_.find(other->second)});
            encodings_.push_back(encoding);
        }
    }

    binary::DynamicTypes types_;
    std::map<std::uint32_t, Entry> entries_;
    std::vector<std::uint32_t> encodings_;
};

} // namespace busbar::fuzz
