#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/crypto/random.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/view.hpp>

#include "session.hpp"

namespace busbar::server::detail {

/// Which references of a node are browsed and what of them is told (Part 4, 5.9.2).
struct BrowseFilter {
    /// no_node: references of every type.
    model::NodeIndex reference_type{model::no_node};
    bool include_subtypes{false};
    BrowseDirection direction{BrowseDirection::Forward};
    /// 0: every NodeClass.
    std::uint32_t node_class_mask{0};
    std::uint32_t result_mask{0};
    /// The View whose nodes alone are told of; no_node: all of the address space.
    model::NodeHandle view{};
};

/// Where a Browse goes on.
struct BrowseState {
    model::NodeHandle node;
    BrowseFilter filter;
    std::uint32_t max_references{0};
    std::size_t position{0};
    std::uint64_t epoch{0};
    /// Where to look on for instances of the node, a type; no_node: nowhere.
    model::NodeIndex instances{model::no_node};
};

/// The continuation points of one session. Their ids are random: nobody can guess one, and one of
/// another session leads nowhere.
class ViewPart final : public SessionPart {
public:
    /// That of the session, made when it is not there yet.
    [[nodiscard]] static ViewPart& of(Session& session);

    /// What the services call first: points of earlier requests may from now on be freed for new
    /// ones (Part 4, 7.9).
    void begin_request() { ++request_; }
    /// The id of a new point. Bad_NoContinuationPoints if the session has no more: all `most`
    /// are of this request, or it is out of memory.
    [[nodiscard]] Result<ByteString> add(Session& session, crypto::Random& random,
                                         const BrowseState& state, std::size_t most);
    /// Gives up the point of that id; Bad_ContinuationPointInvalid if there is none.
    [[nodiscard]] Result<BrowseState> take(Session& session, const ByteString& id);
    [[nodiscard]] std::size_t size() const { return points_.size(); }

private:
    static constexpr std::size_t id_size = 16;

    struct Point {
        std::array<std::byte, id_size> id{};
        std::uint64_t request{0};
        BrowseState state;
    };

    /// Oldest first.
    std::vector<Point> points_;
    std::uint64_t request_{0};
};

} // namespace busbar::server::detail
