// An arm of two joints behind an action server of ROS 2 on Fast DDS: follows its trajectory, and reports its joints at 100 Hz.
// An answer identifies its request in parameters outside the message, as in the middleware of ROS 2 on Fast DDS.
// Runs on this machine only. Arguments: the domain, and the name of the arm.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastrtps::rtps;

/// A message in CDR, little-endian, after the four bytes that state this encoding.
using Bytes = std::vector<uint8_t>;
using Identifier = std::vector<uint8_t>;
constexpr size_t FRONT = 4;
constexpr size_t IDENTIFIER = 16;

/// Any message, as its bytes.
struct Any : TopicDataType {
    explicit Any(const std::string &name) {
        setName(name.c_str());
        m_typeSize = 1 << 20;
        m_isGetKeyDefined = false;
    }
    bool serialize(void *data, SerializedPayload_t *payload) override {
        const Bytes &bytes = *static_cast<Bytes *>(data);
        payload->length = bytes.size();
        payload->encapsulation = CDR_LE;
        memcpy(payload->data, bytes.data(), bytes.size());
        return true;
    }
    bool deserialize(SerializedPayload_t *payload, void *data) override {
        static_cast<Bytes *>(data)->assign(payload->data, payload->data + payload->length);
        return true;
    }
    std::function<uint32_t()> getSerializedSizeProvider(void *data) override {
        return [data] { return static_cast<uint32_t>(static_cast<Bytes *>(data)->size()); };
    }
    void *createData() override { return new Bytes; }
    void deleteData(void *data) override { delete static_cast<Bytes *>(data); }
    bool getKey(void *, InstanceHandle_t *, bool) override { return false; }
};

struct Writer {
    Bytes bytes{0, 1, 0, 0};

    template <class T> Writer &put(T number) {
        while ((bytes.size() - FRONT) % sizeof number) bytes.push_back(0);
        const auto *begin = reinterpret_cast<const uint8_t *>(&number);
        bytes.insert(bytes.end(), begin, begin + sizeof number);
        return *this;
    }
    Writer &text(const std::string &text) {
        put<uint32_t>(text.size() + 1);
        bytes.insert(bytes.end(), text.c_str(), text.c_str() + text.size() + 1);
        return *this;
    }
    Writer &identifier(const Identifier &identifier) {
        bytes.insert(bytes.end(), identifier.begin(), identifier.end());
        return *this;
    }
    /// Stamp and frame.
    Writer &header() { return put<int32_t>(0).put<uint32_t>(0).text(""); }
};

struct Reader {
    const Bytes &bytes;
    size_t at = FRONT;

    const uint8_t *take(size_t count) {
        if (count > bytes.size() - at) throw std::runtime_error("the message is too short");
        at += count;
        return bytes.data() + at - count;
    }
    template <class T> T get() {
        while ((at - FRONT) % sizeof(T)) take(1);
        T number;
        memcpy(&number, take(sizeof number), sizeof number);
        return number;
    }
    std::string text() {
        const auto length = get<uint32_t>();
        return std::string(reinterpret_cast<const char *>(take(length)), length - 1);
    }
    Identifier identifier() {
        const uint8_t *begin = take(IDENTIFIER);
        return Identifier(begin, begin + IDENTIFIER);
    }
    void header() {
        get<int32_t>();
        get<uint32_t>();
        text();
    }
    std::vector<double> numbers() {
        std::vector<double> numbers;
        for (auto count = get<uint32_t>(); count > 0; count--) numbers.push_back(get<double>());
        return numbers;
    }
};

std::string name;
DomainParticipant *participant;

Topic *topic(const std::string &topic, const std::string &type) {
    TypeSupport(new Any(type)).register_type(participant);
    return participant->create_topic(topic, type, TOPIC_QOS_DEFAULT);
}

DataWriter *writer(const std::string &to, const std::string &type, ReliabilityQosPolicyKind reliability) {
    DataWriterQos quality = DATAWRITER_QOS_DEFAULT;
    quality.reliability().kind = reliability;
    quality.durability().kind = VOLATILE_DURABILITY_QOS;
    quality.history().depth = 10;
    quality.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return participant->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(topic(to, type), quality);
}

struct Request {
    Bytes bytes;
    SampleIdentity identity;
};

struct Service {
    DataReader *reader;
    DataWriter *answers;

    Service(const std::string &what, const std::string &type) {
        DataReaderQos quality = DATAREADER_QOS_DEFAULT;
        quality.reliability().kind = RELIABLE_RELIABILITY_QOS;
        quality.history().depth = 10;
        quality.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        const std::string action = name + "/follow_joint_trajectory/_action/" + what;
        Topic *requests = topic("rq/" + action + "Request", type + "_Request_");
        reader = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(requests, quality);
        answers = writer("rr/" + action + "Reply", type + "_Response_", RELIABLE_RELIABILITY_QOS);
    }
    bool take(Request &request) {
        SampleInfo info;
        if (reader->take_next_sample(&request.bytes, &info) != ReturnCode_t::RETCODE_OK || !info.valid_data) return false;
        request.identity = info.sample_identity;
        // Clients of ROS 2 give the reader of their answers here.
        const GUID_t &named = info.related_sample_identity.writer_guid();
        if (named != GUID_t::unknown()) request.identity.writer_guid() = named;
        return true;
    }
    void answer(Writer &answer, const Request &request) {
        WriteParams parameters;
        parameters.related_sample_identity(request.identity);
        answers->write(&answer.bytes, parameters);
    }
};

struct Point {
    std::vector<double> positions;
    double time;
};

struct Goal {
    Identifier identifier;
    std::vector<std::string> joints;
    std::vector<Point> points;

    explicit Goal(const Bytes &bytes) {
        Reader reader{bytes};
        identifier = reader.identifier();
        reader.header();
        for (auto count = reader.get<uint32_t>(); count > 0; count--) joints.push_back(reader.text());
        for (auto count = reader.get<uint32_t>(); count > 0; count--) {
            Point point{reader.numbers(), 0.0};
            for (int k = 0; k < 3; k++) reader.numbers(); // velocities, accelerations, effort
            point.time = reader.get<int32_t>();
            point.time += 1e-9 * reader.get<uint32_t>();
            points.push_back(point);
        }
        // No multi-DOF joints, none of their points, four kinds of tolerances (all empty), a time.
        reader.header();
        for (int k = 0; k < 2 + 4 + 2; k++) {
            if (reader.get<uint32_t>() != 0) throw std::runtime_error("more than a trajectory");
        }
        if (reader.at != bytes.size()) throw std::runtime_error("more than a goal");
    }
};

int main(int, char **arguments) {
    name = arguments[2];
    DomainParticipantQos here = PARTICIPANT_QOS_DEFAULT;
    auto loopback = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    loopback->interfaceWhiteList.push_back("127.0.0.1");
    here.transport().use_builtin_transports = false;
    here.transport().user_transports.push_back(loopback);
    participant = DomainParticipantFactory::get_instance()->create_participant(std::stoi(arguments[1]), here);

    const std::string actions = "control_msgs::action::dds_::FollowJointTrajectory_";
    Service send_goal("send_goal", actions + "SendGoal");
    Service get_result("get_result", actions + "GetResult");
    Service cancel_goal("cancel_goal", "action_msgs::srv::dds_::CancelGoal");
    DataWriter *feedback = writer("rt/" + name + "/follow_joint_trajectory/_action/feedback", actions + "FeedbackMessage_",
                                  RELIABLE_RELIABILITY_QOS);
    DataWriter *states =
        writer("rt/" + name + "/joint_states", "sensor_msgs::msg::dds_::JointState_", BEST_EFFORT_RELIABILITY_QOS);

    std::map<std::string, double> position{{"right_j0", 0.0}, {"right_j1", 0.0}, {"right_k1", 0.0}};
    std::vector<Goal> goals;                  // at most one
    std::vector<Request> asked;               // requests for results
    std::map<Identifier, int> ended;          // final status of each goal
    std::chrono::steady_clock::time_point begin;
    size_t reached = 0;
    std::array<double, 2> first{};            // joint positions when the goal arrived
    int feedbacks = 0;
    auto end = [&](int status) {
        ended[goals[0].identifier] = status;
        goals.clear();
    };
    puts("ready");
    for (;; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
        Request request;
        while (send_goal.take(request)) try {
                const Goal goal(request.bytes);
                const bool takes = goal.joints.size() == 2 && goal.joints[0] == "right_j0" && goal.joints[1] == "right_j1";
                Writer answer;
                send_goal.answer(answer.put<uint8_t>(takes).put<int32_t>(0).put<uint32_t>(0), request);
                if (takes) {
                    if (!goals.empty()) end(5);
                    goals.push_back(goal);
                    begin = std::chrono::steady_clock::now();
                    reached = feedbacks = 0;
                    first = {position["right_j0"], position["right_j1"]};
                }
            } catch (const std::exception &error) {
                // This request makes no sense here; a server of ROS 2 ignores it, too.
                fprintf(stderr, "a goal cannot be read: %s\n", error.what());
            }
        while (get_result.take(request)) asked.push_back(request);
        while (cancel_goal.take(request)) {
            const bool ours = !goals.empty() && Reader{request.bytes}.identifier() == goals[0].identifier;
            Writer answer;
            cancel_goal.answer(answer.put<int8_t>(ours ? 0 : 2).put<uint32_t>(0), request);
            if (ours) {
                puts("cancelled");
                end(5);
            }
        }
        if (!goals.empty()) {
            const Goal &goal = goals[0];
            const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
            if (reached == 0) {
                // If the first point is later than zero, the joints move to it first.
                const double part = std::min(1.0, elapsed.count() / std::max(1e-9, goal.points[0].time));
                for (int k = 0; k < 2; k++) position[goal.joints[k]] = first[k] + part * (goal.points[0].positions[k] - first[k]);
            }
            for (; reached < goal.points.size() && goal.points[reached].time <= elapsed.count(); reached++) {
                for (int k = 0; k < 2; k++) position[goal.joints[k]] = goal.points[reached].positions[k];
            }
            Writer message;
            message.identifier(goal.identifier).header().put<uint32_t>(0).put<uint32_t>(0);
            feedback->write(&message.bytes);
            feedbacks++;
            if (reached == goal.points.size()) {
                printf("followed %zu %d %.17g %.17g\n", reached, feedbacks, position["right_j0"], position["right_j1"]);
                end(4);
            }
        }
        std::vector<Request> waiting;
        for (const Request &one : asked) {
            const auto found = ended.find(Reader{one.bytes}.identifier());
            Writer answer;
            if (found == ended.end()) waiting.push_back(one);
            else get_result.answer(answer.put<int8_t>(found->second).put<int32_t>(0).text(""), one);
        }
        asked = waiting;
        Writer state;
        state.header().put<uint32_t>(position.size());
        for (const auto &joint : position) state.text(joint.first);
        state.put<uint32_t>(position.size());
        for (const auto &joint : position) state.put<double>(joint.second);
        states->write(&state.put<uint32_t>(0).put<uint32_t>(0).bytes);
        fflush(stdout);
    }
}
