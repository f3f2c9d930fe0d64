// Writes for each drone a workload and a Service, by whose name others reach it; the key is a Secret.
#include "command_lines.hpp"
#include "writer.hpp"
#include "yaml.hpp"

#include <algorithm>
#include <set>

namespace hive {
namespace {

/// Kubernetes names have lower-case letters, digits and hyphens.
std::string label_of(const std::string& name)
{
    std::string label;
    for (const char c : name)
        label += c == '_' || c == '.' ? '-' : (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
    while (label.ends_with('-'))
        label.pop_back();
    return label;
}

/// The plan with names valid in Kubernetes; the drones get these names too.
SwarmPlan relabelled(SwarmPlan plan)
{
    std::set<std::string> labels;
    plan.name = label_of(plan.name);
    for (auto& drone : plan.drones) {
        drone.name = label_of(drone.name);
        const bool letter_first = drone.name.front() >= 'a' && drone.name.front() <= 'z';
        if (!letter_first || drone.name.size() > 63)
            throw Error(Errc::invalid_argument, drone.name + " is not a valid Service name",
                        "start with a letter; use at most 63 characters");
        if (!labels.insert(drone.name).second)
            throw Error(Errc::invalid_argument, "two drones would be called " + drone.name + " in Kubernetes",
                        "they must differ in more than upper case, '_' and '.'");
    }
    for (auto& connection : plan.connections) {
        if (connection.options.group == connection.from.drone)
            connection.options.group = label_of(connection.from.drone);
        connection.from.drone = label_of(connection.from.drone);
        connection.to.drone = label_of(connection.to.drone);
    }
    return plan;
}

OrderedJson labels_of(const SwarmPlan& plan, const SwarmDrone& drone)
{
    return {{"app.kubernetes.io/part-of", plan.name}, {"app.kubernetes.io/name", drone.name}};
}

OrderedJson probe(const SwarmDrone& drone, int period_s)
{
    return {{"exec", {{"command", {"hivectl", "wait", drone.name, "--timeout", "5"}}}},
            {"periodSeconds", period_s},
            {"timeoutSeconds", 6}};
}

OrderedJson container(const std::vector<std::string>& words, int port, bool key, const ExportOptions& options)
{
    OrderedJson result{{"name", "drone"}, {"image", options.image}, {"command", OrderedJson::array()}};
    for (const auto& word : words) {
        std::string text;
        for (const char c : word)
            text += c == '$' ? "$$" : std::string(1, c);  // $(NAME) is a variable in Kubernetes
        result["command"].push_back(text);
    }
    result["ports"] = {{{"name", "hive"}, {"containerPort", port}}};
    if (key) {
        result["env"] = {{{"name", "HIVE_KEY"}, {"value", "/etc/hive/swarm.key"}}};
        result["volumeMounts"] = {{{"name", "key"}, {"mountPath", "/etc/hive"}, {"readOnly", true}}};
    }
    return result;
}

OrderedJson drone_container(const SwarmDrone& drone, const CommandLines& lines, const ExportOptions& options)
{
    auto result = container(lines.of(drone), CommandLines::only_port, !drone.insecure, options);
    result["startupProbe"] = probe(drone, 2);
    result["startupProbe"]["failureThreshold"] = 30;
    result["livenessProbe"] = probe(drone, 10);
    result["resources"] = {{"requests", {{"cpu", "250m"}, {"memory", "128Mi"}}}};
    return result;
}

OrderedJson pod(const SwarmPlan& plan, const SwarmDrone& drone, OrderedJson one)
{
    OrderedJson spec;
    if (drone.restart != Restart::always)
        spec["restartPolicy"] = drone.restart == Restart::never ? "Never" : "OnFailure";
    if (drone.host != Place::here)
        spec["nodeSelector"] = {{"kubernetes.io/hostname", machine_name(drone.host)}};
    spec["containers"] = OrderedJson::array({std::move(one)});
    if (!drone.insecure)
        spec["volumes"] = {{{"name", "key"}, {"secret", {{"secretName", "hive-key"}, {"defaultMode", 256}}}}};  // 0400
    return {{"metadata", {{"labels", labels_of(plan, drone)}}}, {"spec", std::move(spec)}};
}

/// A drone with `restart: always` becomes a Deployment, any other a Job.
OrderedJson workload(const SwarmPlan& plan, const SwarmDrone& drone, OrderedJson one)
{
    const OrderedJson metadata{{"name", drone.name}, {"labels", labels_of(plan, drone)}};
    auto the_pod = pod(plan, drone, std::move(one));
    if (drone.restart == Restart::always)
        return {{"apiVersion", "apps/v1"},
                {"kind", "Deployment"},
                {"metadata", metadata},
                {"spec",
                 {{"replicas", 1},
                  {"strategy", {{"type", "Recreate"}}},
                  {"selector", {{"matchLabels", labels_of(plan, drone)}}},
                  {"template", std::move(the_pod)}}}};
    const int tries = drone.restart == Restart::never ? 0 : 1'000'000;
    return {{"apiVersion", "batch/v1"},
            {"kind", "Job"},
            {"metadata", metadata},
            {"spec", {{"backoffLimit", tries}, {"template", std::move(the_pod)}}}};
}

/// A Deployment, which Prometheus finds by the annotations of its pod.
OrderedJson metrics_workload(const SwarmPlan& plan, const CommandLines& lines, const ExportOptions& options)
{
    const bool insecure = std::ranges::all_of(plan.drones, &SwarmDrone::insecure);
    const SwarmDrone server{.name = CommandLines::metrics_name, .restart = Restart::always, .insecure = insecure};
    auto result = workload(plan, server, container(lines.metrics(), CommandLines::metrics_port, !insecure, options));
    result["spec"]["template"]["metadata"]["annotations"] = {
        {"prometheus.io/scrape", "true"},
        {"prometheus.io/port", std::to_string(CommandLines::metrics_port)},
        {"prometheus.io/path", "/metrics"}};
    return result;
}

OrderedJson service_of(const SwarmPlan& plan, const SwarmDrone& drone)
{
    return {{"apiVersion", "v1"},
            {"kind", "Service"},
            {"metadata", {{"name", drone.name}, {"labels", labels_of(plan, drone)}}},
            {"spec",
             {{"selector", labels_of(plan, drone)},
              {"ports", {{{"name", "hive"}, {"port", CommandLines::only_port}, {"targetPort", "hive"}}}}}}};
}

}  // namespace

ExportedFiles write_kubernetes(const SwarmPlan& given, const ExportOptions& options)
{
    const auto plan = relabelled(given);
    const CommandLines lines(plan, CommandLines::Machines::one_each);
    OrderedJson kustomization{{"apiVersion", "kustomize.config.k8s.io/v1beta1"},
                              {"kind", "Kustomization"},
                              {"resources", {plan.name + ".yaml"}}};
    std::string head = "# The swarm " + plan.name + ", a pod for each drone. Start it:\n";
    if (std::ranges::any_of(plan.drones, [](const SwarmDrone& drone) { return !drone.insecure; })) {
        kustomization["secretGenerator"] = {{{"name", "hive-key"}, {"files", {"swarm.key"}}}};
        kustomization["generatorOptions"] = {{"disableNameSuffixHash", true}};
        head += "#   cp ~/.config/hive/swarm.key .\n";
    }
    std::string manifests;
    for (const auto& drone : plan.drones)
        manifests += "---\n" + yaml_text(service_of(plan, drone)) + "---\n"
                     + yaml_text(workload(plan, drone, drone_container(drone, lines, options)));
    if (options.metrics)
        manifests += "---\n" + yaml_text(metrics_workload(plan, lines, options));
    return {{"kustomization.yaml", head + "#   kubectl apply -k .\n" + yaml_text(kustomization)},
            {plan.name + ".yaml", manifests}};
}

}  // namespace hive
