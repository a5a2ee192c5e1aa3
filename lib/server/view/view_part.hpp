#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <span>

#include <busbar/crypto/random.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/view.hpp>

#include "server/session/session.hpp"

namespace busbar::server::detail {

/// Selects the references of a node that are browsed and the described fields (Part 4, 5.9.2).
struct BrowseFilter {
    /// no_node: references of every type.
    model::NodeIndex reference_type{model::no_node};
    bool include_subtypes{false};
    BrowseDirection direction{BrowseDirection::Forward};
    /// 0: every NodeClass.
    std::uint32_t node_class_mask{0};
    std::uint32_t result_mask{0};
    /// The View that limits the results; no_node: the whole address space.
    model::NodeHandle view{};
};

/// The place where a Browse continues.
struct BrowseState {
    model::NodeHandle node;
    BrowseFilter filter;
    std::uint32_t max_references{0};
    std::size_t position{0};
    /// Where to continue the search for instances of the node, a type; no_node: nowhere.
    model::NodeIndex instances{model::no_node};
};

/// The continuation points of one session. Their ids are random, so that they cannot be guessed,
/// and one of another session is invalid. A point lives until it is used, released or needed for
/// another, or the session ends (Part 4, 7.9), whatever happens to other nodes than its own.
class ViewPart final : public SessionPart {
    static constexpr std::size_t id_size = 16;

public:
    struct Point final : model::NodeWatch {
        Point(std::uint64_t of_request, const BrowseState& s) : request{of_request}, state{s} {}
        void node_changed(model::NodeIndex, bool is_removed) override { is_lost = !is_removed; }

        std::array<std::byte, id_size> id{};
        std::uint64_t request;
        BrowseState state;
        bool is_lost{false};
    };
    using Points = std::list<Point>;

    /// Returns the session's, created on first use.
    [[nodiscard]] static ViewPart& of(Session& session);

    /// Called first by the services: points of earlier requests may from now on be freed for new
    /// ones (Part 4, 7.9).
    void begin_request() { ++request_; }
    /// Returns the id of a new point. Bad_NoContinuationPoints if the session has no more: all
    /// `most` belong to this request, or it is out of memory.
    [[nodiscard]] Result<ByteString> add(Session& session, crypto::Random& random,
                                         const model::AddressSpace& space, const BrowseState& state,
                                         std::size_t most);
    /// Removes the point with this id; Bad_ContinuationPointInvalid if there is none, or its
    /// position has become invalid. Its node may be removed. The rest of it goes to `used`.
    [[nodiscard]] Result<BrowseState> take(Session& session, const ByteString& id, Points& used);
    /// Called when the request has failed: restores the points that it used, and removes those that
    /// it created.
    void take_back(Session& session, Points& used);
    [[nodiscard]] std::size_t size() const { return points_.size(); }

private:
    static constexpr std::size_t point_memory =
        sizeof(Point) + 2 * sizeof(void*) + model::node_watch_memory;

    /// The oldest first.
    Points points_;
    std::uint64_t request_{0};
};

} // namespace busbar::server::detail
