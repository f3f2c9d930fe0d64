// Writes for each drone a workload and a Service, by whose name others reach it; the key is a Secret.
#include "../directory.hpp"
#include "../engines/engine.hpp"
#include "command_lines.hpp"
#include "needs.hpp"
#include "writer.hpp"
#include "yaml.hpp"

#include <map>

namespace hive {
namespace {

constexpr int user = 65532;          ///< any but root
constexpr int video_group = 44;      ///< of the devices, in Debian and Ubuntu
constexpr std::size_t longest = 52;  ///< names of StatefulSets become labels with a suffix

/// "doorway-camera", and "door-way--camera" if the swarm has a hyphen, so that two swarms in a namespace have no name
/// in common: a name without "--" ends the swarm at its first hyphen, and any other one at the first "--".
std::string object_name(const std::string& swarm, const std::string& drone)
{
    auto label = label_of(drone);
    while (label.find("--") != label.npos)
        label.erase(label.find("--"), 1);
    const auto name = swarm + (swarm.find('-') == swarm.npos ? "-" : "--") + label;
    if (name.front() < 'a' || name.size() > longest)
        throw Error(Errc::invalid_argument, name + " is not a valid Service name",
                    "start the name of the swarm with a letter; use at most 52 characters");
    return name;
}

/// By drone; the server of the metrics counts as one.
std::map<std::string, std::string> object_names(const SwarmPlan& plan, bool metrics)
{
    std::map<std::string, std::string> names, drones;
    const auto add = [&](const std::string& drone) {
        const auto name = names[drone] = object_name(label_of(plan.name), drone);
        if (!drones.emplace(name, drone).second)
            throw Error(Errc::invalid_argument, "two drones would be called " + name + " in Kubernetes",
                        "they must differ in more than upper case, '_', '.' and repeated '-'");
    };
    for (const auto& drone : plan.drones)
        add(drone.name);
    if (metrics)
        add(CommandLines::metrics_name);
    return names;
}

/// Writes the manifests of one swarm.
class Manifests {
public:
    Manifests(const SwarmPlan& plan, const ExportOptions& options)
        : plan_(plan),
          options_(options),
          swarm_(label_of(plan.name)),
          names_(object_names(plan, options.metrics)),
          needs_(needs_of(plan, options.interface_of)),
          lines_(plan, CommandLines::Machines::one_each, names_)
    {
    }
    [[nodiscard]] ExportedFiles files() const;

private:
    [[nodiscard]] OrderedJson metadata(const SwarmDrone& drone) const
    {
        return {{"name", names_.at(drone.name)}, {"labels", labels(drone)}};
    }
    [[nodiscard]] OrderedJson labels(const SwarmDrone& drone) const
    {
        return {{"app.kubernetes.io/part-of", swarm_}, {"app.kubernetes.io/name", label_of(drone.name)}};
    }
    [[nodiscard]] OrderedJson container(const SwarmDrone& drone, const std::vector<std::string>& words, int port) const;
    [[nodiscard]] OrderedJson drone_container(const SwarmDrone& drone) const;
    [[nodiscard]] OrderedJson pod(const SwarmDrone& drone, OrderedJson one) const;
    [[nodiscard]] OrderedJson workload(const SwarmDrone& drone, OrderedJson one) const;
    [[nodiscard]] OrderedJson service(const SwarmDrone& drone) const;
    [[nodiscard]] OrderedJson metrics() const;
    [[nodiscard]] const Needs& needs(const SwarmDrone& drone) const;
    [[nodiscard]] std::string key() const { return swarm_ + "-key"; }

    const SwarmPlan& plan_;
    const ExportOptions& options_;
    std::string swarm_;
    std::map<std::string, std::string> names_;
    std::map<std::string, Needs> needs_;
    CommandLines lines_;
};

OrderedJson probe(const SwarmDrone& drone, int period_s)
{
    return {{"exec", {{"command", {"hivectl", "wait", drone.name, "--timeout", "5"}}}},
            {"periodSeconds", period_s},
            {"timeoutSeconds", 6}};
}

std::string volume_name(std::size_t number) { return "data-" + std::to_string(number); }

/// Folders are those of the node that the file names; otherwise claims, which a StatefulSet keeps.
bool has_claims(const SwarmDrone& drone, const Needs& needs)
{
    return drone.host == Place::here && !needs.folders.empty();
}

OrderedJson volume_mounts(const SwarmDrone& drone, const Needs& needs)
{
    auto mounts = OrderedJson::array();
    for (const auto* paths : {&needs.folders, &needs.devices})
        for (const auto& path : *paths)
            mounts.push_back({{"name", volume_name(mounts.size())}, {"mountPath", path}});
    if (!drone.insecure)
        mounts.push_back({{"name", "key"}, {"mountPath", "/etc/hive"}, {"readOnly", true}});
    return mounts;
}

/// Everything that is mounted except claims.
OrderedJson volumes(const SwarmDrone& drone, const Needs& needs, const std::string& key)
{
    auto volumes = OrderedJson::array();
    std::size_t number = 0;
    for (const auto* paths : {&needs.folders, &needs.devices})
        for (const auto& path : *paths) {
            const auto* type = paths == &needs.devices ? "CharDevice" : "Directory";
            const auto name = volume_name(number++);
            if (paths == &needs.devices || !has_claims(drone, needs))
                volumes.push_back({{"name", name}, {"hostPath", {{"path", path}, {"type", type}}}});
        }
    if (!drone.insecure)  // readable by fsGroup alone: the files belong to root
        volumes.push_back({{"name", "key"}, {"secret", {{"secretName", key}, {"defaultMode", 0440}}}});
    return volumes;
}

OrderedJson claims(const Needs& needs)
{
    auto claims = OrderedJson::array();
    for (std::size_t i = 0; i < needs.folders.size(); ++i)
        claims.push_back(
            {{"metadata", {{"name", volume_name(i)}}},
             {"spec", {{"accessModes", {"ReadWriteOnce"}}, {"resources", {{"requests", {{"storage", "10Gi"}}}}}}}});
    return claims;
}

/// The amounts of the file are requested, and are limits; otherwise a little is requested.
OrderedJson resources(const SwarmDrone& drone)
{
    OrderedJson resources{{"requests", {{"cpu", "250m"}, {"memory", "128Mi"}}}};
    const auto say = [&](const char* name, int amount, const char* unit) {
        if (amount > 0)
            resources["requests"][name] = resources["limits"][name] = std::to_string(amount) + unit;
    };
    say("cpu", drone.cpus, "");
    say("memory", drone.memory_mib, "Mi");
    say("nvidia.com/gpu", drone.gpus, "");
    return resources;
}

const Needs& Manifests::needs(const SwarmDrone& drone) const
{
    static const Needs none;  // of the server for the metrics
    const auto found = needs_.find(drone.name);
    return found == needs_.end() ? none : found->second;
}

OrderedJson Manifests::container(const SwarmDrone& drone, const std::vector<std::string>& words, int port) const
{
    OrderedJson result{{"name", "drone"}, {"image", options_.image}, {"command", OrderedJson::array()}};
    for (const auto& word : words)
        result["command"].push_back(doubled(word, '$'));  // $(NAME) is a variable in Kubernetes
    result["ports"] = {{{"name", "hive"}, {"containerPort", port}}};
    if (!drone.insecure)
        result["env"] = {{{"name", "HIVE_KEY"}, {"value", "/etc/hive/swarm.key"}}};
    if (auto mounts = volume_mounts(drone, needs(drone)); !mounts.empty())
        result["volumeMounts"] = std::move(mounts);
    if (needs(drone).devices.empty())
        result["securityContext"] = {{"allowPrivilegeEscalation", false}, {"capabilities", {{"drop", {"ALL"}}}}};
    else
        result["securityContext"] = {{"privileged", true}};  // no other container may open devices of the node
    return result;
}

OrderedJson Manifests::drone_container(const SwarmDrone& drone) const
{
    auto result = container(drone, lines_.of(drone), CommandLines::only_port);
    result["startupProbe"] = probe(drone, 2);
    result["startupProbe"]["failureThreshold"] = 30;
    result["readinessProbe"] = result["livenessProbe"] = probe(drone, 10);
    result["resources"] = resources(drone);
    return result;
}

OrderedJson Manifests::pod(const SwarmDrone& drone, OrderedJson one) const
{
    OrderedJson spec{{"securityContext",
                      {{"runAsNonRoot", true},
                       {"runAsUser", user},
                       {"runAsGroup", user},
                       {"fsGroup", user},
                       {"seccompProfile", {{"type", "RuntimeDefault"}}}}}};
    if (!needs(drone).devices.empty())
        spec["securityContext"]["supplementalGroups"] = {video_group};
    if (drone.host != Place::here)
        spec["nodeSelector"] = {{"kubernetes.io/hostname", machine_name(drone.host)}};
    spec["containers"] = OrderedJson::array({std::move(one)});
    if (auto all = volumes(drone, needs(drone), key()); !all.empty())
        spec["volumes"] = std::move(all);
    return {{"metadata", {{"labels", labels(drone)}}}, {"spec", std::move(spec)}};
}

/// A Job would refuse another template, so a changed file could not be applied.
OrderedJson Manifests::workload(const SwarmDrone& drone, OrderedJson one) const
{
    const bool keeps = has_claims(drone, needs(drone));
    OrderedJson spec{
        {"replicas", 1}, {"selector", {{"matchLabels", labels(drone)}}}, {"template", pod(drone, std::move(one))}};
    if (keeps) {
        spec["serviceName"] = names_.at(drone.name);
        spec["volumeClaimTemplates"] = claims(needs(drone));
    } else {
        spec["strategy"] = {{"type", "Recreate"}};  // a name is only for one
    }
    return {{"apiVersion", "apps/v1"},
            {"kind", keeps ? "StatefulSet" : "Deployment"},
            {"metadata", metadata(drone)},
            {"spec", std::move(spec)}};
}

/// A Deployment, which Prometheus finds by the annotations of its pod.
OrderedJson Manifests::metrics() const
{
    const SwarmDrone server{.name = CommandLines::metrics_name, .insecure = !lines_.with_key()};
    auto one = container(server, lines_.metrics(), CommandLines::metrics_port);
    one["readinessProbe"] = {{"tcpSocket", {{"port", "hive"}}}};
    one["resources"] = resources(server);
    auto result = workload(server, std::move(one));
    result["spec"]["template"]["metadata"]["annotations"] = {
        {"prometheus.io/scrape", "true"},
        {"prometheus.io/port", std::to_string(CommandLines::metrics_port)},
        {"prometheus.io/path", "/metrics"}};
    return result;
}

OrderedJson Manifests::service(const SwarmDrone& drone) const
{
    return {{"apiVersion", "v1"},
            {"kind", "Service"},
            {"metadata", metadata(drone)},
            {"spec",
             {{"selector", labels(drone)},
              {"ports", {{{"name", "hive"}, {"port", CommandLines::only_port}, {"targetPort", "hive"}}}}}}};
}

ExportedFiles Manifests::files() const
{
    OrderedJson kustomization{{"apiVersion", "kustomize.config.k8s.io/v1beta1"},
                              {"kind", "Kustomization"},
                              {"resources", {swarm_ + ".yaml"}}};
    std::string head = "# The swarm " + plan_.name + ", a pod for each drone. Start it:\n";
    if (lines_.with_key()) {
        // kustomize adds a hash of the key to the name, so that pods are replaced when the key changes.
        kustomization["secretGenerator"] = {{{"name", key()},
                                             {"files", {"swarm.key"}},
                                             {"options", {{"labels", {{"app.kubernetes.io/part-of", swarm_}}}}}}};
        head += "#   cp ~/.config/hive/swarm.key .\n";
    }
    std::string manifests;
    for (const auto& drone : plan_.drones)
        manifests += "---\n" + yaml_text(service(drone)) + "---\n" + yaml_text(workload(drone, drone_container(drone)));
    if (options_.metrics)
        manifests += "---\n" + yaml_text(metrics());
    return {{"kustomization.yaml", head + "#   kubectl apply -k .\n" + yaml_text(kustomization)},
            {swarm_ + ".yaml", manifests}};
}

}  // namespace

ExportedFiles write_kubernetes(const SwarmPlan& plan, const ExportOptions& options)
{
    return Manifests(plan, options).files();
}

}  // namespace hive
