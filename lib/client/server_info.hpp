#pragma once

#include <busbar/client/requester.hpp>
#include <busbar/types/attribute.hpp>

namespace busbar::client::detail {

/// Reads what ServerInfo holds, in one request if the server lets us, else node by node.
class ServerInfoReader {
public:
    explicit ServerInfoReader(std::size_t max_names) : max_names_{max_names} {}

    /// The next request; only while there is one.
    [[nodiscard]] ReadRequest request() const;
    /// True when everything was asked. What a server does not have is as it is by default; a server
    /// that lets us read nothing at all has no more to say. Bad if it answers what was not asked.
    [[nodiscard]] Result<bool> take(const Result<ReadResponse>& response);
    [[nodiscard]] const ServerInfo& info() const { return info_; }

private:
    void take(std::size_t node, const DataValue& value);

    ServerInfo info_;
    std::size_t max_names_;
    std::size_t next_{0};
    std::size_t batch_{SIZE_MAX};
};

/// Whether both say the same of the server, but for its state.
[[nodiscard]] bool is_same(const ServerInfo& a, const ServerInfo& b);

/// The structures of namespace 0, and those of `tables` whose namespaces the server has.
[[nodiscard]] binary::TypeRegistry types_at(const ServerInfo& info,
                                            const std::vector<binary::TypeRegistry::Table>& tables);

/// Server_ServerStatus_State and SecondsTillShutdown.
[[nodiscard]] ReadRequest state_request();
/// Takes them into `info`; false if they are not there.
bool take_state(const ReadResponse& response, ServerInfo& info);

} // namespace busbar::client::detail
