#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <busbar/net/client_loop.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/method.hpp>

namespace busbar::bench {

/// A Method that the user of a session may call, and the Object that has it.
struct AdministrationMethod {
    /// "FileDirectoryType.CreateFile", by the BrowseName of the Object where its type has none.
    std::string name;
    NodeId object;
    NodeId method;
    std::vector<Argument> inputs;
};

/// Of each type of Object below Objects the first one's Methods, those first that make what others
/// take; without those that end the server, and those of Subscriptions.
[[nodiscard]] Result<std::vector<AdministrationMethod>> find_methods(net::ClientLoop& loop);

/// Calls Methods many at a time with arguments that make sense: names are all different, handles
/// and nodes are those that Methods of the same Object gave.
class AdministrationCalls {
public:
    /// How the Methods of one Call ended.
    struct Outcome {
        std::size_t good{0};
        std::size_t bad{0};
        /// The symbolic name of the first bad status; "Good" if there is none.
        std::string status{"Good"};
    };

    /// So many of the Method in one Call.
    [[nodiscard]] CallRequest request(const AdministrationMethod& method, std::size_t count);
    /// Sends that, and waits as long as the loop does for an answer.
    [[nodiscard]] Result<Outcome> call(net::ClientLoop& loop, const AdministrationMethod& method,
                                       std::size_t count);

private:
    struct Given {
        std::uint32_t handle{0};
        std::vector<NodeId> nodes;
    };

    [[nodiscard]] Variant value_of(const Argument& argument, std::size_t number,
                                   const Given& given);
    [[nodiscard]] Variant array_of(const Argument& argument);
    void note(const CallResponse& response, Given& given) const;

    /// By the text of the Object's NodeId.
    std::map<std::string, Given> given_;
    /// Of the names that were used.
    std::size_t names_{0};
};

} // namespace busbar::bench
