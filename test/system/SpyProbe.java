import java.awt.Component;
import java.awt.Container;
import java.awt.Rectangle;
import java.awt.Robot;
import java.awt.Window;
import java.io.File;
import java.nio.file.Files;
import java.nio.file.Path;
import java.nio.file.StandardCopyOption;
import javax.imageio.ImageIO;
import javax.swing.JTable;
import javax.swing.SwingUtilities;

/**
 * A Java agent that looks over lcm-spy's shoulder: twice a second it writes the table that the window shows to a file,
 * one tab-separated line a row, and a picture of the screen beside it. Usage: java -javaagent:probe.jar=FILE ...
 */
public final class SpyProbe {
  public static void premain(String file) {
    Thread thread = new Thread(() -> watch(Path.of(file)), "spy-probe");
    thread.setDaemon(true);
    thread.start();
  }

  private static void watch(Path file) {
    try {
      while (true) {
        Thread.sleep(500);
        StringBuilder text = new StringBuilder();
        SwingUtilities.invokeAndWait(() -> {
          for (Window window : Window.getWindows()) appendTables(window, text);
        });
        if (text.length() > 0) write(file, text.toString());
      }
    } catch (Exception e) {
      e.printStackTrace();
    }
  }

  private static void appendTables(Container container, StringBuilder text) {
    for (Component child : container.getComponents()) {
      if (child instanceof JTable) append((JTable) child, text);
      else if (child instanceof Container) appendTables((Container) child, text);
    }
  }

  private static void append(JTable table, StringBuilder text) {
    for (int row = 0; row < table.getRowCount(); ++row) {
      for (int column = 0; column < table.getColumnCount(); ++column)
        text.append(String.valueOf(table.getValueAt(row, column)).trim()).append('\t');
      text.append('\n');
    }
  }

  private static void write(Path file, String text) throws Exception {
    Rectangle screen = new Rectangle(java.awt.Toolkit.getDefaultToolkit().getScreenSize());
    ImageIO.write(new Robot().createScreenCapture(screen), "png", new File(file + ".png"));
    Path half = Path.of(file + ".part");
    Files.writeString(half, text);
    Files.move(half, file, StandardCopyOption.ATOMIC_MOVE, StandardCopyOption.REPLACE_EXISTING);
  }
}
