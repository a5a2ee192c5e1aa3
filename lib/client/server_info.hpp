#pragma once

#include <busbar/client/requester.hpp>
#include <busbar/types/attribute.hpp>

namespace busbar::client::detail {

/// Reads the contents of ServerInfo, in one request if the server allows it, else node by node.
class ServerInfoReader {
public:
    explicit ServerInfoReader(std::size_t max_names) : max_names_{max_names} {}

    /// Returns the next request; only while there is one.
    [[nodiscard]] ReadRequest request() const;
    /// Returns true when everything was read. Values that a server does not have keep their
    /// defaults; a server that allows no reading at all has no more to say. Fails if the answer
    /// does not fit the request.
    [[nodiscard]] Result<bool> take(const Result<ReadResponse>& response);
    [[nodiscard]] const ServerInfo& info() const { return info_; }

private:
    void take(std::size_t node, const DataValue& value);

    ServerInfo info_;
    std::size_t max_names_;
    std::size_t next_{0};
    std::size_t batch_{SIZE_MAX};
};

/// Returns whether both are the same except for the server's state.
[[nodiscard]] bool is_same(const ServerInfo& a, const ServerInfo& b);

/// Returns the structures of namespace 0, and those of `tables` whose namespaces the server has.
[[nodiscard]] binary::TypeRegistry types_at(const ServerInfo& info,
                                            const std::vector<binary::TypeRegistry::Table>& tables);

/// Server_ServerStatus_State and SecondsTillShutdown.
[[nodiscard]] ReadRequest state_request();
/// Stores the answer in `info`; returns false if it is incomplete.
bool take_state(const ReadResponse& response, ServerInfo& info);

} // namespace busbar::client::detail
