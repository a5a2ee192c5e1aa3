#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/administration/authorities.hpp>
#include <busbar/administration/setting_list.hpp>
#include <busbar/core/log.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// Shows the settings as Variables of the server's own namespace, below an Object "Settings" of the
/// Objects folder, in folders named by the parts of their names. Properties show the default, range
/// and unit, whether the setting was changed online and whether it waits for a restart. The values
/// of one Write are applied together, as are those of one call of the Method Set.
///
/// Thing::Settings and Thing::SecuritySettings determine the roles that may read and change them.
class SettingNodes final : public server::DataSource {
public:
    struct Needs {
        server::Server& server;
        SettingList& list;
        SettingOwner& owner;
        /// Runs the Method, and posts to the server's thread.
        NodeTable& table;
        LogSink& log;
        const WallClock& clock;
        Authorities authorities;
    };

    explicit SettingNodes(const Needs& needs) : needs_{needs} {}

    /// Adds the nodes; the problem is about a node that exists already.
    [[nodiscard]] Configured<void> add_nodes();

    [[nodiscard]] server::DataSourceOptions options() const override
    {
        return own_source_options();
    }
    void read(server::ReadBatch batch) override;
    void write(server::WriteBatch batch) override;

private:
    /// The part of a node's handle in addition to the setting's index.
    struct Aspect {
        static constexpr std::uint64_t value = 0;
        static constexpr std::uint64_t waits = 1;
        static constexpr std::uint64_t changed = 2;
        static constexpr std::uint64_t count = 3;
    };

    [[nodiscard]] Result<model::NodeIndex> add_folder(model::NodeIndex parent,
                                                      std::string_view path);
    [[nodiscard]] Result<void> add_setting(std::size_t index);
    [[nodiscard]] Result<void> add_properties(model::NodeIndex node, std::size_t index);
    [[nodiscard]] Result<void> add_method();
    [[nodiscard]] model::NodeAccess access(const Setting& setting) const;
    [[nodiscard]] Variant value_of(std::uint64_t handle) const;
    void write_set(server::WriteBatch& batch);
    [[nodiscard]] bool may_change(const server::UserIdentity& user, const std::string& name) const;
    void set(server::MethodCall& call);

    Needs needs_;
    model::NodeIndex root_{model::no_node};
    std::uint16_t namespace_{0};
};

} // namespace busbar::administration::detail
